# Builds the example of a plug-in as a stranger does, outside this tree and against an installed Cairn, and has it go
# through the contract that every front-end must keep, and through a run of the host against a daemon.
set(work ${BUILD}/outside_plugin)
include(${CMAKE_CURRENT_LIST_DIR}/installed.cmake)
file(COPY ${SOURCE}/frontends/examples/odometry_only/ DESTINATION ${work}/project)
build_outside(${work}/project)
set(ENV{CAIRN_FRONTEND} ${work}/build/odometry_only.so)
run(${CONTRACT} --gtest_filter=Of/FrontendContract.*/env:Plugins.RunInTheHostAgainstADaemon)

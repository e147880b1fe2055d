# For tests of an installed Cairn: empties the folder `work` and installs BUILD to ${work}/prefix.
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work}/project)

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    string(JOIN " " command ${ARGV})
    message(FATAL_ERROR "exit code ${result} of: ${command}\n${output}")
  endif()
endfunction()

# Configures the outside project in `folder` and builds it in ${work}/build.
function(build_outside folder)
  run(${CMAKE_COMMAND} -S ${folder} -B ${work}/build -G ${GENERATOR} -D CMAKE_BUILD_TYPE=Release
    -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_PREFIX_PATH=${work}/prefix)
  run(${CMAKE_COMMAND} --build ${work}/build)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)

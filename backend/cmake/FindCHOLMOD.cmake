# CHOLMOD with AMD, and the BLAS and OpenMP runtime it runs on: target CHOLMOD::CHOLMOD.
# Also used by an installed Cairn, whose static library leaves these to the final link.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
find_library(AMD_LIBRARY amd)
find_library(OPENBLAS_LIBRARY openblas)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CHOLMOD
  REQUIRED_VARS CHOLMOD_LIBRARY CHOLMOD_INCLUDE_DIR AMD_LIBRARY OPENBLAS_LIBRARY
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libsuitesparse-dev libopenblas-dev")

if(CHOLMOD_FOUND AND NOT TARGET CHOLMOD::CHOLMOD)
  add_library(CHOLMOD::CHOLMOD INTERFACE IMPORTED)
  target_include_directories(CHOLMOD::CHOLMOD INTERFACE ${CHOLMOD_INCLUDE_DIR})
  # gomp: Debian's CHOLMOD runs on GCC's OpenMP, whichever compiler builds what calls it.
  target_link_libraries(CHOLMOD::CHOLMOD INTERFACE ${CHOLMOD_LIBRARY} ${AMD_LIBRARY} ${OPENBLAS_LIBRARY} gomp)
endif()
mark_as_advanced(CHOLMOD_INCLUDE_DIR CHOLMOD_LIBRARY AMD_LIBRARY OPENBLAS_LIBRARY)

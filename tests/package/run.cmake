# Configures, builds and runs a consumer project:
#   cmake -DKIND=… -DSOURCE=… -DBUILD=… -DINSTALL_FROM=… -DCOMPILER=… [-DOTHER_COMPILER=…] [-DFLAGS=…] -P run.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "failed (${result}): ${ARGN}")
  endif()
endfunction()

file(REMOVE_RECURSE ${BUILD})
set(launcher -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
if(KIND STREQUAL "find_package")
  # One package, and programs by each compiler, optimised and not, with flags other than the library's.
  run(${CMAKE_COMMAND} --install ${INSTALL_FROM} --prefix ${BUILD}/prefix)
  foreach(compiler ${COMPILER} ${OTHER_COMPILER})
    get_filename_component(name ${compiler} NAME)
    run(${CMAKE_COMMAND} -S ${SOURCE}/${KIND} -B ${BUILD}/${name} -G "Ninja Multi-Config"
        -DCMAKE_CXX_COMPILER=${compiler} ${launcher} -DCMAKE_PREFIX_PATH=${BUILD}/prefix -DFLAGS=${FLAGS})
    foreach(type Debug Release)
      run(${CMAKE_COMMAND} --build ${BUILD}/${name} --config ${type} --target layouts)
      run(${BUILD}/${name}/${type}/layouts)
    endforeach()
  endforeach()
  get_filename_component(name ${COMPILER} NAME)
  run(${CMAKE_COMMAND} --build ${BUILD}/${name} --config Release --target consumer)
  run(${BUILD}/${name}/Release/consumer)
else()
  # Without optimisation: what is tested is the build, and it takes a third of the time.
  run(${CMAKE_COMMAND} -S ${SOURCE}/${KIND} -B ${BUILD}/build -G Ninja -DCMAKE_CXX_COMPILER=${COMPILER} ${launcher}
      -DCMAKE_BUILD_TYPE=Debug)
  run(${CMAKE_COMMAND} --build ${BUILD}/build)
  run(${BUILD}/build/consumer)
endif()

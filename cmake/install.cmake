include(CMakePackageConfigHelpers)

install(TARGETS taut EXPORT tautTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(room ${taut_public})
  install(DIRECTORY ${room}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
endforeach()
if(TAUT_BENCH)
  install(TARGETS taut_bench EXPORT tautTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(FILES bench/include/taut/compare.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/taut)
endif()
install(EXPORT tautTargets NAMESPACE taut:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/taut)
configure_package_config_file(cmake/tautConfig.cmake.in tautConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/taut)
write_basic_package_version_file(tautConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/tautConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/tautConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/taut)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/licenses/taut)

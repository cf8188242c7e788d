# cmake --install: headers, libraries, the prt command and the package that find_package(prt) reads.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(prt_libraries GLOBAL PROPERTY PRT_LIBRARIES)
install(TARGETS ${prt_libraries} EXPORT prtTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(folder precompute compress runtime)
  install(DIRECTORY ${folder} DESTINATION include/prt FILES_MATCHING PATTERN "*.h")
endforeach()
install(EXPORT prtTargets NAMESPACE prt:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/prt)
configure_package_config_file(tools/cmake/prtConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/prtConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/prt)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/prtConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/prtConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/prtConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/prt)
if(TARGET prt)
  install(TARGETS prt RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

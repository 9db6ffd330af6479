# Installs the libraries, headers, data and program, and describes them to CMake and pkg-config.
include(CMakePackageConfigHelpers)

set(modules core)
set(libraries_private -pthread)
if(RAGTOP_WITH_TBB)
    list(PREPEND libraries_private -ltbb)
endif()
if(RAGTOP_WITH_QHULL)
    list(PREPEND libraries_private -lqhull_r)
endif()
if(RAGTOP_BUILD_ASSETS)
    # Dependants first, as a linker reading static archives in order wants them.
    list(PREPEND modules assets vehicles cooked ragdolls)
    list(PREPEND libraries_private -lassimp -lurdfdom_model -lconsole_bridge -ltinyxml -ltinygltf -lmeshoptimizer -lfmt)
    install(DIRECTORY assets/data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/ragtop OPTIONAL)
    if(RAGTOP_BUILD_DEMOS)
        list(PREPEND modules serve)
        install(DIRECTORY demos/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} OPTIONAL)
    endif()
endif()

foreach(module IN LISTS modules)
    install(TARGETS ragtop_${module} EXPORT ragtopTargets)
    install(DIRECTORY ${module}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} OPTIONAL)
endforeach()
if(TARGET ragtop)
    install(TARGETS ragtop)
    # The page, where scripts/page.sh has built it before this is installed.
    install(FILES build/page/ragtop.html DESTINATION ${CMAKE_INSTALL_DATADIR}/ragtop/page OPTIONAL)
endif()

# The package works from the build tree as well as installed: its files lie side by side in both.
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/ragtop)
set(RAGTOP_DATA_DIR ${CMAKE_INSTALL_DATADIR}/ragtop)
configure_package_config_file(cmake/ragtopConfig.cmake.in ${PROJECT_BINARY_DIR}/ragtopConfig.cmake
    INSTALL_DESTINATION ${package_dir} PATH_VARS RAGTOP_DATA_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/ragtopConfigVersion.cmake COMPATIBILITY SameMinorVersion)
export(EXPORT ragtopTargets NAMESPACE ragtop:: FILE ${PROJECT_BINARY_DIR}/ragtopTargets.cmake)
install(EXPORT ragtopTargets NAMESPACE ragtop:: DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/ragtopConfig.cmake ${PROJECT_BINARY_DIR}/ragtopConfigVersion.cmake
    DESTINATION ${package_dir})

# pkg-config finds the prefix from where the file lies, so that `cmake --install --prefix` may move it.
file(RELATIVE_PATH pc_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" pc_prefix ${pc_prefix})
list(TRANSFORM modules PREPEND -lragtop_ OUTPUT_VARIABLE pc_libraries)
list(JOIN pc_libraries " " pc_libraries)
list(JOIN libraries_private " " pc_libraries_private)
list(TRANSFORM RAGTOP_PUBLIC_DEFINITIONS PREPEND -D OUTPUT_VARIABLE pc_flags)
list(JOIN pc_flags " " pc_flags)
list(JOIN RAGTOP_PUBLIC_OPTIONS " " pc_options)
configure_file(cmake/ragtop.pc.in ${PROJECT_BINARY_DIR}/ragtop.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/ragtop.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

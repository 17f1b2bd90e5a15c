# What `cmake --install` puts where: header, library, program, and the two ways for a consumer to find them. Included
# by the top-level CMakeLists.txt after the targets frm and frm_cli exist.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(FRM_INSTALL_CMAKEDIR "${CMAKE_INSTALL_LIBDIR}/cmake/frm")

install(TARGETS frm EXPORT frmTargets
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}"
    INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
if(NOT frm_can_share)
    # What a static library is linked with must be there to be linked.
    install(TARGETS frm_zstd frm_openmp EXPORT frmTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
endif()
install(FILES "${PROJECT_SOURCE_DIR}/include/frm.h" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")

if(TARGET frm_bake_shared)
    install(TARGETS frm_bake_shared EXPORT frmTargets
        LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
        RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}"
        INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
    install(FILES "${PROJECT_SOURCE_DIR}/include/frm_bake.h" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
endif()

if(TARGET frm_cli)
    # The program finds its library beside itself, wherever the tree is moved to.
    file(RELATIVE_PATH frm_bin_to_lib "/${CMAKE_INSTALL_BINDIR}" "/${CMAKE_INSTALL_LIBDIR}")
    set_target_properties(frm_cli PROPERTIES INSTALL_RPATH "$ORIGIN/${frm_bin_to_lib}")
    install(TARGETS frm_cli RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
    # Reports are drawn by the Python binding, which the program looks for at ../share/frm/python.
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/bindings/python/frm" DESTINATION share/frm/python
        PATTERN __pycache__ EXCLUDE)
endif()

install(EXPORT frmTargets NAMESPACE frm:: DESTINATION "${FRM_INSTALL_CMAKEDIR}")
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/frmConfig.cmake.in" "${PROJECT_BINARY_DIR}/frmConfig.cmake"
    INSTALL_DESTINATION "${FRM_INSTALL_CMAKEDIR}")
# Before 1.0 a minor version may change the interface, so that 0.1 does not stand in for 0.2.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/frmConfigVersion.cmake"
    VERSION "${PROJECT_VERSION}" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/frmConfig.cmake" "${PROJECT_BINARY_DIR}/frmConfigVersion.cmake"
    DESTINATION "${FRM_INSTALL_CMAKEDIR}")

file(RELATIVE_PATH FRM_PC_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" FRM_PC_PREFIX "${FRM_PC_PREFIX}")
configure_file("${CMAKE_CURRENT_LIST_DIR}/frm.pc.in" "${PROJECT_BINARY_DIR}/frm.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/frm.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
if(TARGET frm_bake_shared)
    configure_file("${CMAKE_CURRENT_LIST_DIR}/frm_bake.pc.in" "${PROJECT_BINARY_DIR}/frm_bake.pc" @ONLY)
    install(FILES "${PROJECT_BINARY_DIR}/frm_bake.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
endif()

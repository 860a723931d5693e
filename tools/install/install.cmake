# Installation: libraries, headers, command, a CMake package with a component for each library, pkg-config files.
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Selvage)
file(RELATIVE_PATH SELVAGE_PC_TO_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})

# What the C++ compiler links and the C compiler does not, for programs in C with a static library.
set(CXX_RUNTIME "")
foreach(library IN LISTS CMAKE_CXX_IMPLICIT_LINK_LIBRARIES)
    if(NOT library IN_LIST CMAKE_C_IMPLICIT_LINK_LIBRARIES AND NOT library MATCHES "/|^-")
        string(APPEND CXX_RUNTIME " -l${library}")
    endif()
endforeach()

string(STRIP "${CXX_RUNTIME}" CXX_RUNTIME)

# For users of a static library: PACKAGES of pkg-config, and LIBS for the linker.
function(selvage_install name export description headers)
    cmake_parse_arguments(ARG "" "" "PACKAGES;LIBS" ${ARGN})
    install(TARGETS ${name} EXPORT Selvage-${export}
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
            RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    install(EXPORT Selvage-${export} NAMESPACE Selvage:: DESTINATION ${package})
    install(DIRECTORY ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
    set(PC_NAME ${name})
    set(PC_DESCRIPTION ${description})
    set(PC_REQUIRES "")
    set(PC_PRIVATE "")
    set(PC_CFLAGS "")
    if(NOT name STREQUAL selvage)
        set(PC_REQUIRES "Requires: selvage\n")
    endif()
    if(NOT BUILD_SHARED_LIBS)
        list(JOIN ARG_PACKAGES ", " packages)
        list(JOIN ARG_LIBS " " libs)
        set(PC_PRIVATE "Libs.private: ${libs} ${CXX_RUNTIME} -lm\n")
        if(packages)
            string(PREPEND PC_PRIVATE "Requires.private: ${packages}\n")
        endif()
        set(PC_CFLAGS " -DSLV_STATIC")
    endif()
    configure_file(tools/install/selvage.pc.in ${CMAKE_BINARY_DIR}/${name}.pc @ONLY)
    install(FILES ${CMAKE_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

selvage_install(selvage selvage "Per-face textures: meshes, .ptx files, borders, images" runtime/include/selvage
                PACKAGES OpenEXR libpng libdeflate LIBS -losdCPU ${CMAKE_THREAD_LIBS_INIT})
if(SELVAGE_GL)
    selvage_install(selvage-gl gl "Per-face textures in OpenGL shaders" runtime/include/selvage LIBS -lsquish -ldl)
    install(FILES ${SELVAGE_SAMPLE_GLSL} ${CMAKE_CURRENT_SOURCE_DIR}/shaders/wrap/selvage_wrap.glsl
            DESTINATION ${CMAKE_INSTALL_DATADIR}/selvage)
    set_target_properties(selvage-gl PROPERTIES INSTALL_RPATH "$ORIGIN")
endif()
if(SELVAGE_BAKE)
    selvage_install(selvage-bake bake "Making per-face textures" bake/include/selvage PACKAGES jansson
                    LIBS -lembree${EMBREE_VERSION})
    set_target_properties(selvage-bake PROPERTIES INSTALL_RPATH "$ORIGIN")
    set(PAINT_PACKAGES jansson)
    if(MYPAINT_FOUND)
        list(APPEND PAINT_PACKAGES libmypaint)
    endif()
    selvage_install(selvage-paint paint "Painting on per-face textures" bake/include/selvage PACKAGES ${PAINT_PACKAGES}
                    LIBS -lembree${EMBREE_VERSION})
    set_target_properties(selvage-paint PROPERTIES INSTALL_RPATH "$ORIGIN")
endif()
if(SELVAGE_COMMAND)
    install(TARGETS selvage-command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    set_target_properties(selvage-command PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
    if(TARGET selvage-studio)
        install(TARGETS selvage-studio RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/selvage)
        set_target_properties(selvage-studio PROPERTIES INSTALL_RPATH "$ORIGIN/../../${CMAKE_INSTALL_LIBDIR}")
    endif()
endif()

configure_package_config_file(tools/install/SelvageConfig.cmake.in ${CMAKE_BINARY_DIR}/SelvageConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/SelvageConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/SelvageConfig.cmake ${CMAKE_BINARY_DIR}/SelvageConfigVersion.cmake DESTINATION ${package})
if(TARGET selvage-mpi)
    install(TARGETS selvage-mpi LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()

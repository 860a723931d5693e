# Turns text files into a C table { name, text }, the name being the path below a folder. Shaders go into the GL library; the report page goes into the command.
function(selvage_embed symbol output base)
    set(files ${ARGN})
    add_custom_command(
        OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} -DSYMBOL=${symbol} -DOUTPUT=${output} -DBASE=${base} "-DFILES=${files}"
                -P ${CMAKE_CURRENT_SOURCE_DIR}/shaders/embed_files.cmake
        DEPENDS ${files} ${CMAKE_CURRENT_SOURCE_DIR}/shaders/embed_files.cmake
        VERBATIM)
endfunction()

file(GLOB_RECURSE SHADER_FILES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/shaders/*.glsl
     ${CMAKE_CURRENT_SOURCE_DIR}/shaders/*.vert ${CMAKE_CURRENT_SOURCE_DIR}/shaders/*.frag)
set(SELVAGE_SHADER_TABLE ${CMAKE_BINARY_DIR}/generated/shader_table.c)
selvage_embed(slvi_shader_table ${SELVAGE_SHADER_TABLE} ${CMAKE_CURRENT_SOURCE_DIR}/shaders ${SHADER_FILES})

file(GLOB REPORT_FILES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/tools/compare/report/*.html
     ${CMAKE_CURRENT_SOURCE_DIR}/tools/compare/report/*.css ${CMAKE_CURRENT_SOURCE_DIR}/tools/compare/report/*.js)
set(SELVAGE_REPORT_TABLE ${CMAKE_BINARY_DIR}/generated/report_table.c)
selvage_embed(report_table ${SELVAGE_REPORT_TABLE} ${CMAKE_CURRENT_SOURCE_DIR}/tools/compare/report ${REPORT_FILES})

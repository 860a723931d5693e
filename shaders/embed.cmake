# Turns text files into a C table { name, text }, the name being the path below a folder. Shaders go into the GL library; the report page goes into the command.
function(selvage_embed symbol output base)
    set(files ${ARGN})
    add_custom_command(
        OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} -DSYMBOL=${symbol} -DOUTPUT=${output} -DBASE=${base} "-DFILES=${files}"
                -P ${PROJECT_SOURCE_DIR}/shaders/embed_files.cmake
        DEPENDS ${files} ${PROJECT_SOURCE_DIR}/shaders/embed_files.cmake
        VERBATIM)
endfunction()

file(GLOB_RECURSE SHADER_FILES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/shaders/*.glsl
     ${CMAKE_CURRENT_SOURCE_DIR}/shaders/*.vert ${CMAKE_CURRENT_SOURCE_DIR}/shaders/*.frag)
set(SELVAGE_SHADER_TABLE ${CMAKE_BINARY_DIR}/generated/shader_table.c)
selvage_embed(slvi_shader_table ${SELVAGE_SHADER_TABLE} ${CMAKE_CURRENT_SOURCE_DIR}/shaders ${SHADER_FILES})

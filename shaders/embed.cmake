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

# The same lookups as one file, for those who take it from where it is installed.
file(GLOB STRATEGY_FILES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/shaders/strategy/*.glsl)
set(SELVAGE_SAMPLE_GLSL ${CMAKE_BINARY_DIR}/generated/selvage_sample.glsl)
add_custom_command(
    OUTPUT ${SELVAGE_SAMPLE_GLSL}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${SELVAGE_SAMPLE_GLSL} -DBASE=${CMAKE_CURRENT_SOURCE_DIR}/shaders
            "-DSTRATEGIES=${STRATEGY_FILES}" -P ${CMAKE_CURRENT_SOURCE_DIR}/shaders/join_parts.cmake
    DEPENDS ${SHADER_FILES} ${CMAKE_CURRENT_SOURCE_DIR}/shaders/selvage_sample.glsl.in
            ${CMAKE_CURRENT_SOURCE_DIR}/shaders/join_parts.cmake
    VERBATIM)
add_custom_target(selvage-sample-glsl ALL DEPENDS ${SELVAGE_SAMPLE_GLSL})

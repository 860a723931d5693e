# Reports every #include that runs against the order of the tree. Arguments: source files, paths relative to the root, as in
# runtime/mesh/obj_read.c. Exits with 1 if there was one.

BEGIN {
    # Public headers: each may include only those of lower rank.
    split("result half threads camera adjacency mesh surface tessellation texture source form border edge_aligned htex ptx ptx_writer ptx_check ptx_diff ptx_resize image filter cache", names, " ")
    split("0      1    1       2      2         3    4       4.5          4       4.2    4.8  5      5.5          5.5  6   6.4        6.5       6.5      6.5        6     6.7    6.6", ranks, " ")
    for (i in names) public[names[i]] = ranks[i] + 0
    gl = 7; everything = 9
    # How far a folder of the library may look: among the folders, and among the public headers.
    split("base adjacency mesh texture form ptx image cache filter gl", names, " ")
    split("0    1         2    2       3    3   3     4     5      5", ranks, " ")
    split("1    2         4.5  4.2     5.5  6.5 6     6.6   6.7    7", reach, " ")
    # Headers of inline functions alone, which need nothing of the library's inside.
    for_bake["adjacency/edge.h"]; for_bake["texture/bilinear.h"]
    for (i in names) { layer[names[i]] = ranks[i] + 0; sees[names[i]] = reach[i] + 0 }
}

function rank_of(name) {
    if (name in public) return public[name]
    if (name ~ /^gl_/) return gl
    if (FROM_BAKE[name]) return gl + 1
    if (name == "selvage") return everything
    return -1
}

function report(why) {
    print FILENAME ":" FNR ": #include " target ": " why
    failed = 1
}

function check_public(name,   rank) {
    rank = rank_of(name)
    if (rank < 0)
        report("no such header is known to include_order.awk: give it a rank")
    else if (is_public) {
        if (FROM_BAKE[own] && rank == gl) report("bake does without OpenGL")
        else if (own ~ /^gl_/ && rank == gl) return
        else if (own != "selvage" && rank >= rank_of(own)) report("a public header of no lower rank")
    } else if (folder in layer) {
        if (rank > sees[folder]) report("runtime/" folder " may not know this header")
        else if (folder == "mesh" && (name == "texture" || name == "source")) report("runtime/mesh may not know textures")
    } else if (folder == "bake" && (rank == gl || rank == everything))
        report("bake does without OpenGL")
}

function check_internal(from) {
    if (is_public)
        report("a public header may include public headers only")
    else if (folder in layer) {
        if (from != folder && layer[from] >= layer[folder])
            report("runtime/" folder " may not look into runtime/" from)
    } else if (folder != "bake")
        report(folder " may include public headers and its own only")
    else if (from != "base" && !(path in for_bake))
        report("of the runtime's inner headers bake may include those of base and a few of functions only")
}

# The headers of bake/include are known by where they lie.
BEGIN {
    for (i = 1; i < ARGC; i++)
        if (ARGV[i] ~ /bake\/include\/selvage\/[a-z_0-9]+\.h$/) {
            name = ARGV[i]
            sub(/.*\//, "", name)
            sub(/\.h$/, "", name)
            FROM_BAKE[name] = 1
        }
}

FNR == 1 {
    is_public = FILENAME ~ /include\/selvage\//
    own = FILENAME
    sub(/.*\//, "", own)
    sub(/\.h$/, "", own)
    folder = FILENAME
    sub(/.*runtime\//, "", folder)
    if (folder == FILENAME) {
        folder = FILENAME ~ /(^|\/)bake\// ? "bake" : FILENAME ~ /(^|\/)tools\// ? "tools" : "assets"
    } else
        sub(/\/.*/, "", folder)
}

/^[ \t]*#[ \t]*include[ \t]*[<"]/ {
    target = $0
    sub(/^[ \t]*#[ \t]*include[ \t]*/, "", target)
    sub(/[>"][^>"]*$/, "", target)
    path = substr(target, 2)
    target = target (substr(target, 1, 1) == "<" ? ">" : "\"")
    if (path ~ /\.\.\//)
        report("a path may not climb out of its folder")
    else if (path ~ /^selvage\//) {
        name = path
        sub(/^selvage\//, "", name)
        sub(/\.h$/, "", name)
        check_public(name)
    } else if (target ~ /^"/ && path ~ /\//) {
        from = path
        sub(/\/.*/, "", from)
        if (from in layer) check_internal(from)
        else if (folder in layer) report("no folder of runtime/ has this name")
    } else if (target ~ /^"/ && is_public)
        report("a public header may include public headers only")
    else if (path ~ /^(GL|EGL)\// && folder != "gl")
        report("OpenGL belongs in runtime/gl")
    else if (path ~ /^squish/ && folder != "gl")
        report("libsquish belongs behind the shim in runtime/gl")
    else if (path ~ /^embree/ && folder != "bake")
        report("Embree belongs in bake")
    else if (path ~ /^opensubdiv\// && folder != "mesh")
        report("OpenSubdiv belongs behind the shim in runtime/mesh")
}

END { exit failed }

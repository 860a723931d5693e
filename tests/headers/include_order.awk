# Reports every #include that runs against the order of the tree. Arguments: the table of the order (order.txt), then source
# files, paths relative to the root, as in runtime/mesh/obj_read.c. Exits with 1 if there was one.

function read_order(   i, names, kind, folder) {
    kind = $1
    if (kind == "row") {
        rows++
        for (i = 2; i <= NF; i++) row[$i] = rows
        return
    }
    folder = $2
    sub(/:$/, "", folder)
    if (kind == "public")
        for (i = 3; i <= NF; i++) {
            home[$i] = folder
            place[$i] = ++places
        }
    else if (kind == "inner")
        for (i = 3; i <= NF; i++) open_to[folder, $i] = 1
    else if (kind == "inside") {
        ranks[folder]++
        for (i = 3; i <= NF; i++) {
            split($i, names, "=")
            rank[folder, names[1]] = ranks[folder]
            one_with[folder, names[1]] = $i ~ /=/ ? names[2] : names[1]
        }
    } else if (kind == "without_gl")
        for (i = 2; i <= NF; i++) without_gl[$i] = 1
    else if (kind == "foreign")
        foreign[$2] = $3
    else if (kind != "circle") { # that is circles.awk's
        print FILENAME ":" FNR ": '" kind "' is no kind of line"
        failed = 1
    }
}

# The name under which the table has a public header: its own, or one with a star.
function listed(name,   star) {
    if (name in home) return name
    for (star in home)
        if (star ~ /\*$/ && index(name, substr(star, 1, length(star) - 1)) == 1) return star
    return ""
}

function report(why) {
    print FILENAME ":" FNR ": #include " target ": " why
    failed = 1
}

function check_public(name,   entry, mine, of) {
    entry = listed(name)
    if (entry == "" && !from_bake[name] && name != "selvage") {
        report("no such header is known to order.txt")
        return
    }
    of = entry == "" ? "" : home[entry]
    if ((of == "gl" || name == "selvage") && folder in without_gl)
        report(folder " does without OpenGL")
    else if (is_public && own != "selvage" && !from_bake[own]) {
        mine = listed(own)
        if (mine == "") return # reported where it is included
        if (of == "" || row[of] > row[home[mine]] || (row[of] == row[home[mine]] && of != home[mine]) ||
            (of == home[mine] && place[entry] >= place[mine] && mine !~ /\*$/))
            report("a public header of no lower rank")
    } else if (folder in row && !is_public && (of == "" || (of != folder && row[of] >= row[folder])))
        report("runtime/" folder " may not know this header")
}

function check_inner(path,   from) {
    from = path
    sub(/\/.*/, "", from)
    if (!(from in row)) {
        if (folder in row) report("no folder of runtime/ has this name")
    } else if (is_public)
        report("a public header may include public headers only")
    else if (folder in row) {
        if (from != folder && row[from] >= row[folder])
            report("runtime/" folder " may not look into runtime/" from)
    } else if (!((folder, from) in open_to) && !((folder, path) in open_to))
        report(folder " may not look into runtime/" from)
}

# The folder below `top` that the table has for a path: itself, or one above it.
function ranked(path) {
    while (path != "" && !((top, path) in rank))
        if (!sub(/\/[^\/]*$/, "", path)) path = ""
    return path == "" ? "" : one_with[top, path]
}

function parent(path) {
    return sub(/\/[^\/]*$/, "", path) ? path : ""
}

function first(path) {
    sub(/\/.*/, "", path)
    return path
}

# Rows below a folder outside of runtime/.
function check_inside(path,   from, to, mine, fine) {
    from = parent(below)
    to = ranked(parent(path))
    mine = ranked(from)
    if (to != "") fine = mine == "" || mine == to || rank[top, mine] > rank[top, to]
    else fine = (top, path) in open_to || mine == "" && (path !~ /\// || first(path) == first(from))
    if (!fine) report(top (from == "" ? "" : "/" from) " may not know this header")
}

# The headers of bake/include are known by where they lie.
BEGIN {
    for (i = 2; i < ARGC; i++)
        if (ARGV[i] ~ /bake\/include\/selvage\/[a-z_0-9]+\.h$/) {
            name = ARGV[i]
            sub(/.*\//, "", name)
            sub(/\.h$/, "", name)
            from_bake[name] = 1
        }
}

FILENAME == ARGV[1] {
    if (NF && $1 !~ /^#/) read_order()
    next
}

FNR == 1 {
    is_public = FILENAME ~ /include\/selvage\//
    own = FILENAME
    sub(/.*\//, "", own)
    sub(/\.h$/, "", own)
    folder = FILENAME
    sub(/.*runtime\//, "", folder)
    if (folder == FILENAME)
        folder = FILENAME ~ /(^|\/)bake\// ? "bake" : FILENAME ~ /(^|\/)tools\// ? "tools" : "assets"
    else
        sub(/\/.*/, "", folder)
    top = below = ""
    for (i in ranks)
        if (index("/" FILENAME, "/" i "/") == 1 && length(i) > length(top)) {
            top = i
            below = substr(FILENAME, length(i) + 2)
        }
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
    } else if (target ~ /^"/ && top != "" && !is_public && !(first(path) in row))
        check_inside(path)
    else if (target ~ /^"/ && path ~ /\//)
        check_inner(path)
    else if (target ~ /^"/ && is_public)
        report("a public header may include public headers only")
    else
        for (start in foreign)
            if (index(path, start) == 1 && folder != foreign[start])
                report("only " foreign[start] " may know this library")
}

END { exit failed }

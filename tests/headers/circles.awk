# Reports files that need each other in a circle. Arguments: order.txt, whose `circle` lines name circles that are still
# borne with, then lines of two files, the first of which needs the second, and what for. Exits with 1 if there was another circle.

function visit(from,   i, list, count) {
    count = split(needs[from], list, " ")
    for (i = 1; i <= count; i++)
        if (!(list[i] in seen)) {
            seen[list[i]] = 1
            visit(list[i])
        }
}

FILENAME == ARGV[1] {
    if ($1 == "circle") {
        circles++
        for (i = 2; i <= NF; i++) borne[$i] = circles
        names[circles] = $0
    }
    next
}

$1 != $2 && !(($1, $2) in known) {
    known[$1, $2] = 1
    needs[$1] = needs[$1] " " $2
    why[$1, $2] = $3
    files[$1] = files[$2] = 1
}

END {
    for (file in files) {
        split("", seen)
        visit(file)
        for (other in seen) reaches[file, other] = 1
    }
    for (file in files) {
        if (!((file, file) in reaches) || reported[file]) continue
        line = ""
        allowed = file in borne
        for (other in files)
            if (((file, other) in reaches) && ((other, file) in reaches)) {
                reported[other] = 1
                line = line " " other
                allowed = allowed && borne[other] == borne[file]
            }
        if (allowed) {
            met[borne[file]] = 1
            continue
        }
        print "these need each other in a circle:" line
        for (other in files)
            if (index(line " ", " " other " ")) {
                count = split(needs[other], list, " ")
                for (i = 1; i <= count; i++)
                    if (index(line " ", " " list[i] " ")) print "    " other " needs " list[i] " for " why[other, list[i]]
            }
        failed = 1
    }
    for (i = 1; i <= circles; i++)
        if (!met[i]) print "no circle any more, so strike it from order.txt: " names[i]
    exit failed
}

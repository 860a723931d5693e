# Makes lookups for `selvage sample`, the same ones every time: awk -v filters='point box' -v count=N -v faces=N
# -v channels=N -v seed=N. Each filter has `count` of them; with bad=1 there are only some that ask for what is not
# there.
function draw() { # 0 to 1; products stay below 2^53, so that every awk has the same numbers
    state = (state * 16807) % 2147483647
    return state / 2147483647
}

function place(   r) { # in a face, on its edges and corners, beyond them
    r = draw()
    if (r < 0.06) return 0
    if (r < 0.12) return 1
    if (r < 0.20) return draw() * 0.01
    if (r < 0.28) return 1 - draw() * 0.01
    if (r < 0.31) return draw() * 1.4 - 0.2
    if (r < 0.36) return int(draw() * 16) / 16
    return draw()
}

function side(   r) {
    r = draw()
    if (r < 0.05) return 0
    return (r < 0.2 ? -1 : 1) * exp(log(2) * (draw() * 11 - 9))
}

function footprint(   r, a, b) {
    r = draw()
    if (r < 0.08) return "0 0 0 0"
    a = side()
    b = side()
    if (r < 0.5) return sprintf("%.8g 0 0 %.8g", a, b)
    if (r < 0.6) return sprintf("%.8g %.8g %.8g %.8g", a, b, a * 2, b * 2)
    return sprintf("%.8g %.8g %.8g %.8g", a, side(), b, side())
}

function query(filter,   first, some, width, blur) {
    first = 0
    some = 0
    if (draw() < 0.3) {
        first = int(draw() * channels)
        some = 1 + int(draw() * (channels - first + 1))
    }
    width = draw() < 0.7 ? 1 : sprintf("%.6g", draw() * 3)
    blur = draw() < 0.7 ? 0 : sprintf("%.6g", draw() * draw() * 0.5)
    return sprintf("%s %d %s %d %s %s %d %d %d %.8g %.8g %s", filter, draw() < 0.5,
                   filter == "bicubic" ? sprintf("%.6g", draw()) : "0", draw() < 0.25, width, blur, first, some,
                   int(draw() * faces), place(), place(), footprint())
}

BEGIN {
    state = 1 + seed % 2147483646
    n = split(filters, names, " ")
    for (k = 1; k <= n && !bad; k++)
        for (i = 0; i < count; i++)
            print query(names[k])
    for (k = 1; k <= n && bad; k++) {
        print names[k], "0 0 0 1 0 0 0", faces, "0.5 0.5 0.1 0 0 0.1"
        print names[k], "0 0 0 1 0 0 0 0 nan 0.5 0.1 0 0 0.1"
        print names[k], "1 0 0 1 0 0 0 0 0.5 0.5 inf 0 0 1e30"
        print names[k], "0 0 0 0 0 0 0 0 0.5 0.5 0.25 0 0 0.25"
    }
}

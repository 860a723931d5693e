# Prints the times of compare_builds.sh --speed, a row for each thing that was timed: the ratio new/old of the medians,
# that of the least times, to which what else the machine does has added least, and the range of the rounds' own ratios.
# Reads rows of what, "old" or "new", and a time, tabs between them. Beyond 5 % a row is marked; the mark says so if
# the least times do not confirm it.
function sort_times(list, n,   i, j, swap) {
    for (i = 2; i <= n; i++)
        for (j = i; j > 1 && list[j] < list[j - 1]; j--) {
            swap = list[j]
            list[j] = list[j - 1]
            list[j - 1] = swap
        }
}

function median(list, n) {
    return n % 2 ? list[(n + 1) / 2] : (list[n / 2] + list[n / 2 + 1]) / 2
}

function beyond(ratio) {
    return ratio > 1.05 ? "slower" : ratio < 1 / 1.05 ? "quicker" : ""
}

function print_row(what,   n, i, a, b, one, low, high, ratio, least, mark) {
    n = count[what, "old"]
    if (n != count[what, "new"]) {
        printf "%-36s not in every round of both builds\n", what
        return
    }
    low = 1e9
    high = 0
    for (i = 1; i <= n; i++) {
        a[i] = time[what, "old", i]
        b[i] = time[what, "new", i]
        one = b[i] / a[i]
        if (one < low) low = one
        if (one > high) high = one
    }
    sort_times(a, n)
    sort_times(b, n)
    ratio = median(b, n) / median(a, n)
    least = b[1] / a[1]
    if (beyond(ratio)) {
        marked++
        mark = "  <- " beyond(ratio)
        if (beyond(least) != beyond(ratio)) mark = mark ", but not by the least times"
        else sure++
    }
    logs += log(ratio)
    least_logs += log(least)
    ratios[++good] = ratio
    printf "%-36s %7.3f %7.3f   %.3f to %.3f%s\n", what, ratio, least, low, high, mark
}

!($1 in seen) {
    seen[$1] = 1
    order[++rows] = $1
}

{ time[$1, $2, ++count[$1, $2]] = $3 }

END {
    printf "\n%-36s %7s %7s   %s\n", "processor time, new/old", "medians", "least", "rounds"
    for (r = 1; r <= rows; r++) print_row(order[r])
    if (!good) exit
    sort_times(ratios, good)
    printf "%d rows timed; ratios of medians from %.3f to %.3f, geometric mean %.3f, of the least times %.3f; ", good,
           ratios[1], ratios[good], exp(logs / good), exp(least_logs / good)
    printf "%d beyond 5 %%, %d of them by the least times too\n", marked, sure
}

# Pipes and texts of every kind are inputs like files, or are refused by their true name.
gzip -c q.txt >q.gz
accepts selvage sample in.ptx -i q.txt
plain=$said
for command in "selvage sample in.ptx <q.gz" "cat q.gz | selvage sample in.ptx" "cat q.txt | selvage sample in.ptx -i -" \
    "cat q.gz | selvage sample in.ptx -i /dev/stdin"; do
    accepts sh -c "$command"
    [ "$said" = "$plain" ] || fail "$command: $said"
done
mkfifo fifo
cat q.gz >fifo &
accepts selvage sample in.ptx -i fifo
[ "$said" = "$plain" ] || fail "a named pipe: $said"
for kind in UTF-16LE UTF-16BE UTF-32LE UTF-32BE; do
    iconv -f UTF-8 -t $kind mesh.obj >wide.obj
    refuses selvage info wide.obj
    says "text in ${kind%?E}"
    iconv -f UTF-8 -t $kind q.txt >wide.txt
    run sh -c "selvage sample in.ptx <wide.txt"
    [ $code = 1 ] || fail "$kind: exit code $code: $said"
    says "text in ${kind%?E}"
done
accepts sh -c "cat in.ptx | selvage info -"
says "faces"
refuses selvage new in.ptx -o blank.ptx
says "is a .ptx file"
misused() {
    run "$@"
    [ $code = 2 ] || fail "$*: exit code $code, expected 2: $said"
    says "--help"
}
misused selvage render in.ptx --mesh - --view - -o x.png
says "both are the standard input"
misused selvage transfer in.ptx x.ptx --to - --from -
for scale in 0 -1 x 1/0; do
    misused selvage transfer in.ptx x.ptx --to mesh.obj --scale-from $scale
done
for verb in info check diff; do
    accepts selvage $verb --help
    says "--out"
done
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n' >more.ply
printf 'element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n' >>more.ply
accepts selvage info more.ply
case $said in *warning*) fail "$said" ;; esac
printf '\n3 0 2 1\n3 2 1 0\n' >>more.ply
accepts selvage info more.ply
says "2 lines follow"

# Texts that an editor began with a byte order mark, that gzip packed, or that come through a pipe.
accepts selvage convert faces out.ptx
accepts selvage render in.ptx --view view.json -o a.png
says "64 x 64"
accepts selvage sample in.ptx --queries queries.txt
says " -> 0.78"
plain=$said
gzip -k view.json queries.txt
accepts selvage render in.ptx --view view.json.gz -o a.png
says "64 x 64"
gzip faces/index.json
accepts selvage convert faces/index.json.gz out2.ptx
accepts selvage diff out.ptx out2.ptx
accepts selvage sample in.ptx --queries queries.txt.gz
[ "$said" = "$plain" ] || fail "packed lookups give something else: $said"
accepts sh -c 'selvage sample in.ptx <queries.txt'
[ "$said" = "$plain" ] || fail "lookups from a pipe give something else: $said"
accepts sh -c 'cat view.json | selvage render in.ptx --view - -o a.png'
says "64 x 64"
for order in FFFE FEFF; do
    printf '\377\376{\0}\0' >wide.json
    [ $order = FFFE ] || printf '\376\377\0{\0}' >wide.json
    refuses selvage render in.ptx --view wide.json -o a.png
    says "wide.json: is text in UTF-16"
    refuses selvage sample in.ptx --queries wide.json
    says "wide.json: is text in UTF-16"
    refuses selvage convert wide.json o.ptx
    says "wide.json: is text in UTF-16"
    cp wide.json wide.obj
    refuses selvage info wide.obj
    says "wide.obj: is text in UTF-16"
done
printf '\357\273\277ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n' >m.ply
printf 'element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n' >>m.ply
for command in 'selvage info m.ply' 'cat m.ply | selvage info -' 'gzip -c m.ply | selvage info -' \
    'selvage info - <m.ply'; do
    accepts sh -c "$command"
    says "control mesh"
done
accepts sh -c 'selvage info - <in.ptx'
says "quad faces"
mkfifo pipe
refuses selvage info pipe
says "pipe: a pipe that nobody writes to"
refuses selvage sample in.ptx --queries pipe
says "pipe: a pipe that nobody writes to"
refuses selvage sample in.ptx --queries queries.txt --out pipe
says "pipe: a pipe that nobody reads from"
accepts sh -c '(sleep 0.2; cat queries.txt >pipe) & selvage sample in.ptx --queries pipe'
[ "$said" = "$plain" ] || fail "lookups from a named pipe give something else: $said"
accepts sh -c '(sleep 0.2; cat pipe) & selvage sample in.ptx --queries queries.txt --out pipe; wait'
[ "$said" = "$plain" ] || fail "answers through a named pipe are something else: $said"
accepts sh -c '(sleep 0.2; cat view.json >pipe) & selvage render in.ptx --view pipe -o a.png'
refuses selvage render in.ptx --view faces -o a.png
says "faces: not a regular file"
for name in faces /dev/null; do
    refuses selvage info $name
    says "$name: not a regular file"
    refuses selvage sample in.ptx --queries $name
    says "$name: not a regular file"
done

# A file without faces is joined with another: it has no range of faces.
accepts selvage merge nofaces.ptx q2.ptx -o out.ptx
says "no faces: nofaces.ptx"
says "faces 0 to 1: q2.ptx"

# A mesh with its faces in another order and their corners turned has the same neighbours, but other places.
accepts selvage check in.ptx --mesh q2.obj
says "verdict: sound"
accepts selvage check in.ptx --mesh q2rot.obj
says "warning: face 0: its corners lie elsewhere than in the mesh inside: where those of face 1 are, turned by 2"
says "verdict: sound, with warnings (0 errors, 2 warnings)"
sed 's/^v 2 /v 2.5 /' q2.obj >moved.obj
accepts selvage check in.ptx --mesh moved.obj
says "by up to 0.5"

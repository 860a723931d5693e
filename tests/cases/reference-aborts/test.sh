# Rays and triangles so far away that Embree would end the process.
for view in view_window_1e38 view_distance_1e30; do
    refuses selvage reference in.ptx -o r.exr --view $view.json --samples 2 --quiet
    says "1e+18"
    [ ! -e r.exr ] || fail "$view: a picture all the same"
done
accepts selvage transfer in.ptx o.ptx --to cube_1e18.obj --force --quiet
refuses selvage reference o.ptx -o r.exr --samples 2 --tess 2 --size 16x16 --quiet
says "1e+18"

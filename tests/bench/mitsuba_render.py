"""Mitsuba 3 at the other end of a pipe, for tests/bench/pictures; run by the Python that has it.

mitsuba_render.py VARIANT THREADS FOLDER/BASE           answers each line `point|sphere SPP [FILE.pfm]` with the seconds it took
mitsuba_render.py VARIANT THREADS FOLDER/BASE FILE.png  one picture with the point light and one sample a pixel, then the end
"""
import sys
import time

import drjit
import mitsuba

variant, threads, base = sys.argv[1:4]
mitsuba.set_variant(variant)
drjit.set_thread_count(int(threads))
if len(sys.argv) > 4:
    bitmap = mitsuba.Bitmap(mitsuba.render(mitsuba.load_file(base + "_point.xml"), spp=1))
    bitmap.convert(mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.UInt8, srgb_gamma=False).write(sys.argv[4])
    sys.exit(0)

scenes, seed = {}, 0
for line in sys.stdin:
    light, spp, *file = line.split()
    if light not in scenes:
        scenes[light] = mitsuba.load_file(f"{base}_{light}.xml")
    seed += 1
    start = time.perf_counter()
    image = mitsuba.render(scenes[light], spp=int(spp), seed=seed)
    drjit.eval(image)
    drjit.sync_thread()
    seconds = time.perf_counter() - start
    if file:
        bitmap = mitsuba.Bitmap(image).convert(mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.Float32, srgb_gamma=False)
        bitmap.write(file[0])
    print(f"{seconds:.6f}", flush=True)

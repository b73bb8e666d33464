"""What asdic run writes, read back by programs that are not ours. A test is skipped where its
program is not installed; `./dev test` installs them."""
import ctypes.util
import json
import os
import re
import resource
import shutil
import subprocess

import tap
from foreign import numpy, tool
from pool import rows_of, run_of
from program import PATH, Folder, asdic, need_device
from run_folder import data, facts, pictures, same, scene


def netcdf_run_of(folder, **changes):
    run = run_of(folder, **changes)
    if not os.path.exists(run + "/run.nc"):
        raise tap.Skip("built without netCDF")
    return run


def test_csv_in_sqlite():
    with Folder() as folder:
        run = run_of(folder)
        rows = rows_of(folder)
        forward = [float(r["level_db"]) for r in rows if r["beam"] == "forward" and r["level_db"]]
        out = tool("sqlite3", "-csv", ":memory:", cwd=run, stdin=(
            ".mode csv\n.import bins.csv bins\n"
            "SELECT count(*), count(DISTINCT ping), max(CAST(bin AS INTEGER)) FROM bins;\n"
            "SELECT max(CAST(level_db AS REAL)) FROM bins WHERE beam = 'forward' AND level_db <> '';\n"
            "SELECT count(*) FROM bins WHERE object_db = '';\n"))
        lines = out.split()
        tap.equal(lines[0], f"{len(rows)},4,{facts(folder, 'r')['bins'] - 1}", "table")
        tap.equal(float(lines[1]), max(forward), "highest level")
        tap.equal(int(lines[2]), sum(r["object_db"] == "" for r in rows), "empty fields")


def test_wide_csv_in_gnuplot_and_sqlite():
    with Folder() as folder:
        long_rows = rows_of(folder) if run_of(folder) else []
        shutil.rmtree(folder / "r")
        run = run_of(folder, edits={"{npy: true,": "{csv: wide,"})
        expected = [float(r["level_db"]) for r in long_rows
                    if r["ping"] == "2" and r["beam"] == "down" and r["level_db"]]
        out = tool("gnuplot", "-e", "set datafile separator ','; set print '-'; "
                   "stats 'bins.csv' every ::1 using 24 name 'L' nooutput; "  # 20.5 m
                   "print sprintf('%d %.9g %.9g', L_records, L_min, L_max)", cwd=run).split()
        column = [float(r["level_db"]) for r in long_rows if r["range_m"] == "20.5"]
        tap.equal((int(out[0]), float(out[1]), float(out[2])), (8, min(column), max(column)),
                  "gnuplot's statistics")
        header, *rows = data(folder, "r", "bins.csv").decode().splitlines()
        tap.equal(header.split(",")[:5], ["ping", "time_s", "beam", "0.5_m", "1.5_m"])
        tap.equal(len(rows), 8, "a row per ping and beam")
        tap.equal([float(x) for x in rows[5].split(",")[3:] if x], expected, "levels of a row")
        out = tool("sqlite3", "-csv", ":memory:", cwd=run, stdin=(
            ".mode csv\n.import bins.csv bins\nSELECT \"20.5_m\" FROM bins WHERE ping = '2' AND "
            "beam = 'down';\n"))
        level = [r["level_db"] for r in long_rows
                 if (r["ping"], r["beam"], r["range_m"]) == ("2", "down", "20.5")]
        tap.equal(out.split(), level, "a cell")


def test_long_csv_in_gnuplot():
    with Folder() as folder:
        run = run_of(folder)
        levels = [float(r["level_db"]) for r in rows_of(folder) if r["level_db"]]
        out = tool("gnuplot", "-e", "set datafile separator ','; set print '-'; "
                   "stats 'bins.csv' every ::1 using 6 name 'L' nooutput; "
                   "print sprintf('%d %.9g %.9g', L_records, L_min, L_max)", cwd=run).split()
        tap.equal((int(out[0]), float(out[1]), float(out[2])),
                  (len(levels), min(levels), max(levels)), "statistics")


def test_npy_in_numpy():
    with Folder() as folder:
        run = run_of(folder)
        out = numpy("import zlib\n"
                    "p = numpy.load('pings.npy'); q = numpy.load('levels.npy')\n"
                    "assert numpy.array_equal(p['level_db'], q, equal_nan=True)\n"
                    "assert q.dtype == numpy.float32, q.dtype\n"
                    "assert p['time_s'].tolist() == [0, 0.05, 0.1, 0.15], p['time_s']\n"
                    "assert p['ping'].tolist() == [0, 1, 2, 3]\n"
                    "assert all(zlib.crc32(r.tobytes()[:-4]) == r['crc32'] for r in p)\n"
                    "t = numpy.genfromtxt('bins.csv', delimiter=',', skip_header=1, usecols=5)\n"
                    "assert numpy.array_equal(t.astype('f4').reshape(q.shape), q, equal_nan=True)\n"
                    "print(q.shape)\n", run)
        tap.equal(out.strip(), f"(4, 2, {facts(folder, 'r')['bins']})", "shape")


FAN = "    fan: {count: 65, sector_deg: 90}"


def test_small_arrays_in_numpy():
    """float16 is the nearest that there is, as numpy rounds; int16 is to a hundredth of a dB."""
    with Folder() as folder:
        run = run_of(folder, edits={"{npy: true,": "{npy: true, npy_float16: true, npy_int16: true,",
                                    "bin_length_m: 1\n":
                                    "bin_length_m: 1\n  blanking_m: 3\n  noise: {enabled: false}\n"})
        out = numpy("q = numpy.load('levels.npy'); h = numpy.load('levels_float16.npy')\n"
                    "i = numpy.load('levels_int16.npy')\n"
                    "assert h.dtype == numpy.float16 and i.dtype == numpy.int16, (h.dtype, i.dtype)\n"
                    "assert numpy.array_equal(h, q.astype('f2'), equal_nan=True)\n"
                    "there = ~numpy.isnan(q)\n"
                    "assert 0 < there.sum() < q.size\n"
                    "assert (i[~there] == -32768).all()\n"
                    "assert abs(i[there] / 100 - q[there]).max() <= 0.00501\n"
                    "print(q.shape == h.shape == i.shape)\n", run)
        tap.equal(out.strip(), "True", "shapes")
        tap.equal(os.path.getsize(run + "/levels_int16.npy") < 0.6 *
                  os.path.getsize(run + "/levels.npy"), True, "half the size")


def test_large_pings_write_no_table_unless_asked():
    """Of 150 bins, 334 beams are more than 50,000 bins and 333 are not."""
    with Folder() as folder:
        path = scene(folder, pings=2, rays=500, receivers="    fan: {count: 334, sector_deg: 90}")
        many = folder.read("pool.yaml").replace("npy: true, ", "").replace("bin_length_m: 1",
                                                                           "bin_length_m: 0.25")
        def files_of(text):
            folder.write("pool.yaml", text)
            done = asdic("run", path, "-o", folder / "r", "--force").check(code=0)
            return {n for n in os.listdir(folder / "r") if n == "bins.csv" or "levels" in n}, done.err
        names, said = files_of(many)
        tap.equal(names, {"levels_float16.npy"})
        for words in said, asdic("check", path).err, asdic("plan", "--no-forecast", path).err:
            tap.contains(words, f"{path}: remark: no bins.csv, which would have some 100 bytes for each bin of 334 "
                                "beams; 'output: {csv: long}' writes it, pings.npy holds the same\n")
        asdic("detect", folder / "r", "--background", "flat").check(code=0)
        asdic("render", folder / "r").check(code=0)
        many = many.replace("[waterfall, ascope, fan]", "[]")
        folder.write("pool.yaml", many)
        for k in (1, 2):
            asdic("run", path, "-o", folder / f"part{k}", "--shard", f"{k}/2").check(code=0)
        asdic("merge", folder / "part1", folder / "part2", "-o", folder / "whole").check(code=0)
        tap.equal(data(folder, "whole", "levels_float16.npy") ==
                  data(folder, "r", "levels_float16.npy"), True, "of parts")
        for edit, wanted in (((", pings: 2", ""), {"bins.csv"}),  # one ping
                             (("count: 334", "count: 333"), {"bins.csv"}),
                             (("output: {", "output: {csv: long, "), {"bins.csv"}),
                             (("output: {", "output: {csv: none, "), set()),
                             (("output: {", "output: {npy: true, "), {"levels.npy"})):
            tap.contains(many, edit[0])
            names, said = files_of(many.replace(*edit))
            tap.equal(names, wanted, edit[1])
            tap.equal("no bins.csv" in said, wanted == {"levels.npy"}, said)
        scanned = many.replace(", pings: 2", "").replace(
            "sonar:\n", "sonar:\n  scan: {sector_deg: 90, step_deg: 45}\n")
        tap.equal(files_of(scanned)[0], {"levels_float16.npy"}, "three pings, none counted in the file")


def test_sizes_are_foretold():
    """What check says against what run writes: records and arrays but for their heads, tables
    about."""
    with Folder() as folder:
        scene(folder, pings=200, rays=300)
        pool = folder.read("pool.yaml").replace("bin_length_m: 1", "bin_length_m: 0.1")
        pool = pool.replace("[waterfall, ascope, fan]", "[]")  # large beside so little
        for number, (edit, tolerance) in enumerate((
                (("npy: true", "csv: none, npy: true, npy_int16: true"), 0.005),
                (("npy: true", "csv: long"), 0.15),
                (("npy: true", "csv: wide, records: levels"), 0.05))):
            tap.contains(pool, edit[0])
            path = folder.write("some.yaml", pool.replace(*edit))
            told = json.loads(asdic("check", "--json", path).check(code=0).out)[0]["output"]
            run = folder / f"foretold{number}"
            asdic("run", path, "-o", run).check(code=0)
            there = sum(os.path.getsize(f"{run}/{name}") for name in os.listdir(run))
            tap.equal(abs(told["bytes"] / there - 1) < tolerance, True,
                      f"{edit[1]}: {told['bytes']} of {there} bytes")


def test_records_as_small_as_asked():
    """Levels are the same to the bit in each form, parts and errors within 16 bits' rounding; parts of
    runs, resumed runs and predictions fit; detection asks for the parts."""
    with Folder() as folder:
        scene(folder, pings=4, rays=500, receivers=FAN)
        pool = folder.read("pool.yaml").replace("npy: true", "csv: none, npy: true")
        pool = pool.replace("seed: 7", "seed: 7, multipath: off").replace("[waterfall, ascope, fan]", "[]")  # a part less
        sizes = {}
        for form in ("full", "compact", "levels"):
            path = folder.write(f"{form}.yaml", pool.replace("output: {", f"output: {{records: {form}, "))
            asdic("run", path, "-o", folder / form).check(code=0)
            told = json.loads(asdic("check", "--json", path).check(code=0).out)[0]["output"]["ping_bytes"]
            cells = 65 * facts(folder, form)["bins"]
            content = data(folder, form, "pings.npy")
            sizes[form] = (len(content) - 10 - int.from_bytes(content[8:10], "little")) // 4
            tap.equal(told, sizes[form] + 4 * cells, "bytes a ping")
            for k in (1, 2):
                asdic("run", path, "-o", folder / f"{form}{k}", "--shard", f"{k}/2").check(code=0)
            asdic("merge", folder / f"{form}1", folder / f"{form}2", "-o", folder / "m", "-f").check(code=0)
            same(folder, form, "m")
            flip = bytearray(content)
            flip[-2 * sizes[form] + 500] ^= 4
            with open(folder / f"{form}/pings.npy", "wb") as file:
                file.write(flip)
            os.unlink(folder / f"{form}/levels.npy")
            asdic("run", path, "-o", folder / form, "--resume").check(code=0)
            same(folder, "m", form)
            done = asdic("detect", folder / form, "--background", "flat")
            tap.equal(done.code, 3 if form == "levels" else 0, done.err)
        tap.equal([sizes[form] - 92 for form in sizes], [32 * cells, 16 * cells, 6 * cells], "bytes")
        numpy("import os\n"
              "full, small, least = (numpy.load(n + '/pings.npy') for n in ('full', 'compact', 'levels'))\n"
              "assert least.dtype.names[-3:] == ('level_db', 'stderr_db', 'crc32')\n"
              "for name in full.dtype.names[7:-1]:\n"
              "    a = full[name]; there = numpy.isfinite(a)\n"
              "    for form in (small, least):\n"
              "        if name not in form.dtype.names:\n"
              "            assert form is least or not there.any(), name\n"
              "            continue\n"
              "        b = form[name].astype('f4')\n"
              "        assert (numpy.isfinite(b) == there).all(), name\n"
              "        assert (abs(a - b)[there] <= (0 if name == 'level_db' else abs(a[there]) * 2**-11)).all()\n",
              folder.path)


def test_compact_records_of_all_terms():
    """What the scene does not have is left out of records that keep all terms, written and read alike."""
    with Folder() as folder:
        scene(folder, pings=2, rays=500)
        pool = folder.read("pool.yaml").replace("output: {", "model: {terms: all}\noutput: {records: compact, ")
        path = folder.write("all.yaml", pool[:pool.index("objects:")] + pool[pool.index("sonar:"):])
        asdic("run", path, "-o", folder / "r").check(code=0)
        numpy("names = numpy.load('r/pings.npy').dtype.names\n"
              "assert 'bottom_db' in names and 'object_db' not in names, names\n", folder.path)
        asdic("render", folder / "r").check(code=0)


def test_size_is_foretold():
    """What check, plan and run say is what the files take, within a tenth."""
    with Folder() as folder:
        path = scene(folder, pings=30, rays=500)
        folder.write("pool.yaml", folder.read("pool.yaml").replace(
            "npy: true,", "npy: true, npy_int16: true,").replace("bin_length_m: 1", "bin_length_m: 0.1"))
        said = asdic("run", path, "-o", folder / "r").check(code=0).err
        taken = sum(len(data(folder, "r", name))
                    for name in ("bins.csv", "pings.npy", "levels.npy", "levels_int16.npy"))
        found = json.loads(asdic("check", path, "--json").check(code=0).out)[0]["output"]
        tap.equal(found["bytes"] >= 30 * found["ping_bytes"], True, "all pings")
        tap.equal(abs(30 * found["ping_bytes"] / taken - 1) < 0.1, True, f"{found} of {taken}")
        whole = f"{1e-6 * found['bytes']:.3g} MB in all; "
        tap.contains(said, whole)
        tap.contains(asdic("check", path).check(code=0).out, whole)
        plan = asdic("plan", path).check(code=0).out
        tap.contains(plan, whole)
        tap.contains(plan, "ms to write it")


def test_what_does_not_fit_is_refused():
    """8 MB a ping, a million pings: 8 TB, more than a disk has left where tests are run."""
    with Folder() as folder:
        text = scene(folder, pings=1000000, rays=500, receivers=FAN.replace("65", "512"))
        folder.write("pool.yaml", folder.read("pool.yaml").replace("bin_length_m: 1", "bin_length_m: 0.05").replace(
            "[waterfall, ascope, fan]", "[]"))
        done = asdic("run", text, "-o", folder / "r").check(code=1)
        tap.contains(done.err, "room for")
        tap.contains(done.err, "--force")
        tap.equal(done.err.count("error:"), 1, done.err)
        tap.equal(os.path.exists(folder / "r"), False, "a folder")
        found = json.loads(asdic("check", text, "--json").check(code=0).out)[0]["output"]
        tap.equal(found["fits"], False)
        asdic("run", text, "-o", folder / "r", "--pings", "0:1").check(code=0)


def cdl_numbers(text, name):
    """Values of a variable as ncdump prints it; None for the fill value."""
    body = re.findall(rf"\n\s*{name} =\s(.*?);", text, re.S)[-1]  # before: a dimension of its name
    return [None if word in ("_", "NaN", "NaNf") else float(word)
            for word in re.split(r"[,\s]+", body.strip())]


def test_netcdf_in_ncdump():
    with Folder() as folder:
        run = netcdf_run_of(folder)
        text = tool("ncdump", "-p", "9,17", "run.nc", cwd=run)
        rows = rows_of(folder)
        for variable, column in (("backscatter_r", "level_db"), ("bottom_db", "bottom_db"),
                                 ("object_db", "object_db"), ("stderr_db", "stderr_db")):
            expected = [float(r[column]) if r[column] else None for r in rows]
            tap.equal(cdl_numbers(text, variable), expected, variable)
        bins = facts(folder, "r")["bins"]
        for line in (f"range_sample = {bins} ;", "beam = 2 ;", "ping_time = 4 ;",
                     "float backscatter_r(ping_time, beam, range_sample) ;",
                     'beam = "forward", "down" ;', ':Conventions = "CF-1.9" ;',
                     "group: Beam_group1 {", "group: Environment {", "group: Platform {",
                     "group: Provenance {", "group: Sonar {"):
            tap.contains(text, line)
        tap.equal(cdl_numbers(text, "ping_time"), [0, 0.05, 0.1, 0.15], "times")
        tap.equal(cdl_numbers(text, "range")[:3], [0.5, 1.5, 2.5], "ranges")
        tap.equal(cdl_numbers(text, "depth"), [5] * 4, "depth")
        # 45 degrees down: forward and down alike.
        tap.equal([round(x, 9) for x in cdl_numbers(text, "beam_direction_x")], [1, 0.707106781])
        tap.equal([round(x, 9) for x in cdl_numbers(text, "beam_direction_z")], [0, 0.707106781])
        storage = tool("ncdump", "-hs", "run.nc", cwd=run)
        for line in ("backscatter_r:_DeflateLevel = 1 ;", 'backscatter_r:_Shuffle = "true" ;',
                     'backscatter_r:_Storage = "chunked" ;', "backscatter_r:_FillValue = NaNf ;"):
            tap.contains(storage, line)


def test_netcdf_in_xarray():
    """Its group of beams is a data set: axes by name, levels by coordinates, the bytes of pings.npy."""
    with Folder() as folder:
        run = netcdf_run_of(folder)
        out = numpy("d = xarray.open_dataset('run.nc', group='Sonar/Beam_group1')\n"
                    "p = numpy.load('pings.npy')\n"
                    "for v, c in (('backscatter_r', 'level_db'), ('surface_db', 'surface_db'),\n"
                    "             ('noise_db', 'noise_db'), ('stderr_db', 'stderr_db')):\n"
                    "    assert d[v].dims == ('ping_time', 'beam', 'range_sample'), d[v].dims\n"
                    "    assert d[v].dtype == numpy.float32, d[v].dtype\n"
                    "    assert numpy.array_equal(d[v].values, p[c], equal_nan=True), v\n"
                    "assert list(d.beam.values) == ['forward', 'down'], d.beam\n"
                    "down = d.backscatter_r.sel(beam='down').isel(ping_time=2)\n"
                    "assert numpy.array_equal(down, p['level_db'][2, 1], equal_nan=True)\n"
                    "print(dict(d.sizes))\n", run, also="xarray, netCDF4")
        tap.contains(out, f"'range_sample': {facts(folder, 'r')['bins']}")


def test_netcdf_in_xarray_without_a_group():
    """What opens without a group's name: levels by time, beam and range in metres."""
    with Folder() as folder:
        run = netcdf_run_of(folder, edits={"{npy: true,": "{npy: true, netcdf: true,",
                                    "bin_length_m: 1\n": "bin_length_m: 1\n  max_range_m: 12.5\n"})
        out = numpy("d = xarray.open_dataset('run.nc')\n"
                    "p = numpy.load('levels.npy')\n"
                    "assert d.level.dims == ('ping_time', 'beam', 'range'), d.level.dims\n"
                    "assert numpy.array_equal(d.level.values, p, equal_nan=True)\n"
                    "assert d.ping_time.values.tolist() == [0, 0.05, 0.1, 0.15], d.ping_time\n"
                    "down = d.level.sel(beam='down', range=7.5).values\n"
                    "assert numpy.array_equal(down, p[:, 1, 7]) and down.max() > 50, down\n"
                    "print(float(d.range[-1]))\n", run, also="xarray, netCDF4")
        tap.equal(out.strip(), "11.5", "the last bin's centre, of a sonar that hears 12.5 m")


def test_netcdf_in_gdal():
    with Folder() as folder:
        run = netcdf_run_of(folder)
        out = tool("gdalinfo", 'NETCDF:"run.nc":/Sonar/Beam_group1/backscatter_r', cwd=run)
        tap.contains(out, f"Size is {facts(folder, 'r')['bins']}, 2")
        tap.contains(out, "Band 4 ")
        tap.contains(out, "Type=Float32")


def test_netcdf_that_is_gone_is_told_before_a_run():
    """The library is found when the file is made; an empty one in front of it is none."""
    with Folder() as folder:
        netcdf_run_of(folder)
        asdic("run", folder / "pool.yaml", "-o", folder / "part").check(code=0)
        name = ctypes.util.find_library("netcdf")
        folder.write(name, "")
        words = f"'output: {{netcdf: true}}', but {name} cannot be loaded; install {name.replace('.so.', '')}, or"
        env = {"LD_LIBRARY_PATH": folder.path}
        tap.contains(asdic("check", folder / "pool.yaml", **env).check(code=0).err, words)
        tap.equal(asdic("run", folder / "pool.yaml", "-o", folder / "gone", **env).check(code=1).err.count(words), 1, "said")
        tap.equal(os.path.exists(folder / "gone"), False, "a folder, which would be in the next run's way")
        tap.equal(asdic("run", folder / "pool.yaml", "-o", "-", **env).check(code=0).err.count(words), 1, "rows alone")
        resumed = asdic("run", folder / "pool.yaml", "-o", folder / "r", "--resume", **env).check(code=0)
        tap.equal(resumed.err.count(words), 1, "said of a run that is complete")
        before = data(folder, "r", "run.nc")
        tap.contains(asdic("merge", "--force", folder / "part", "-o", folder / "r", **env).check(code=1).err, words)
        tap.equal(data(folder, "r", "run.nc") == before, True, "the run that was there")


LARGE = """
version: 1
bottom: {depth_m: 20, type: sand}
sonar: {frequency_khz: 100, ping_rate_hz: 10, max_range_m: 50, source_level_db: 200,
        receivers: {fan: {count: 64, sector_deg: 60}}}
mission: {pose: {position_m: [0, 0, 7]}, pings: 40}
sampling: {rays: 2000}
output: {netcdf: true, csv: none, images: [], records: levels}
"""


def test_netcdf_without_room():
    """Where run.nc, larger than the records, has no room: one sentence, no half of a file, and all pings."""
    need_device()
    with Folder() as folder:
        scene_path = folder.write("large.yaml", LARGE)
        if asdic("run", scene_path, "-o", folder / "r").code != 0:
            raise tap.Skip("built without netCDF")
        records, whole = (os.path.getsize(folder / f"r/{name}") for name in ("pings.npy", "run.nc"))
        for part in (0.02, 0.5, 0.98):
            room = int(records + part * (whole - records))
            for command, kept in ((("run", scene_path), "40 of 40 pings are kept"), (("merge", folder / "r"), "")):
                shutil.rmtree(folder / "full", ignore_errors=True)
                done = subprocess.run([PATH, *command, "-o", folder / "full"], capture_output=True, text=True,
                                      check=False, preexec_fn=lambda n=room: resource.setrlimit(
                                          resource.RLIMIT_FSIZE, (n, n)))  # fmt: skip
                errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
                tap.equal((done.returncode, len(errors)), (1, 1), f"{command[0]} within {room}: {done.stderr}")
                tap.contains(errors[0], "run.nc.part': NetCDF: HDF error; the disk may be full")
                tap.contains(errors[0], kept)
                tap.equal([name for name in os.listdir(folder / "full") if name.startswith("run.nc")]
                          if kept else os.path.exists(folder / "full/run.nc.part"), [] if kept else False,
                          "what is left")
                if kept:
                    asdic("run", scene_path, "-o", folder / "full", "--resume").check(code=0)
                    tap.equal(data(folder, "full", "run.nc") == data(folder, "r", "run.nc"), True, "resumed")


def test_shards_give_the_same_netcdf():
    with Folder() as folder:
        netcdf_run_of(folder)
        for k in (1, 2):
            asdic("run", folder / "pool.yaml", "-o", folder / f"part{k}", "--shard",
                  f"{k}/2").check(code=0)
        asdic("merge", folder / "part1", folder / "part2", "-o", folder / "whole").check(code=0)
        tap.equal(data(folder, "whole", "run.nc") == data(folder, "r", "run.nc"), True, "run.nc")


def test_without_csv():
    with Folder() as folder:
        run_of(folder)
        before = data(folder, "r", "pings.npy")
        run = run_of_again(folder, "{npy: true,", "{csv: none, npy: true,")
        tap.equal((os.path.exists(run + "/bins.csv"), data(folder, "n", "pings.npy") == before),
                  (False, True), "the same in binary only")
        for k in (1, 2):
            asdic("run", folder / "none.yaml", "-o", folder / f"part{k}", "--shard",
                  f"{k}/2").check(code=0)
        asdic("merge", folder / "part1", folder / "part2", "-o", folder / "whole").check(code=0)
        asdic("run", folder / "none.yaml", "-o", folder / "n", "--resume").check(code=0)
        tap.equal(sorted(os.listdir(folder / "whole")), sorted(os.listdir(run)), "files")
        done = asdic("run", folder / "none.yaml", "-o", "-").check(code=0)
        tap.equal(done.out.encode() == data(folder, "r", "bins.csv"), True, "asked for by -o -")


def run_of_again(folder, old, new):
    """A run 'n' of the scene 'none.yaml', the pool with an edit."""
    path = folder.write("none.yaml", folder.read("pool.yaml").replace(old, new))
    asdic("run", path, "-o", folder / "n").check(code=0)
    return folder / "n"


def test_bins_go_to_standard_output():
    with Folder() as folder:
        run_of(folder)
        for name in "-", "/dev/stdout":
            done = asdic("run", folder / "pool.yaml", "-o", name, cwd=folder.path).check(code=0)
            tap.equal(done.out.encode() == data(folder, "r", "bins.csv"), True, "bins.csv")
            tap.contains(done.err, "standard output: ")
            tap.equal(sorted(folder.names()), ["pool.yaml", "r"], "files")
            asdic("run", folder / "pool.yaml", "-o", name, "--resume").check(code=2, out="")


def test_terrain_keeps_land_and_holes():
    """A slope that comes out of the water in the east, with a corner that nobody surveyed: a hole is none of -9999 m."""
    with Folder() as folder:
        rows = [[12 - 2 * column for column in range(11)] for _ in range(11)]  # from 12 m to 8 m above the water
        rows[10][0] = rows[10][1] = rows[9][0] = rows[9][1] = -9999
        folder.write("shore.asc", "ncols 11\nnrows 11\nxllcenter -20\nyllcenter -20\ncellsize 4\nNODATA_value -9999\n"
                     + "\n".join(" ".join(map(str, row)) for row in rows) + "\n")
        run_of(folder, pings=2, edits={
            "bottom: {depth_m: 12, type: sand}": "bottom: {grid: {file: shore.asc}, type: sand}", "fan]": "plan]",
            "position_m: [20, 0, 6]": "position_m: [10, -14, 4]", "position_m: [0, 0, 5]": "position_m: [0, -14, 5]"})
        head, cells = {}, []
        for line in data(folder, "r", "terrain.asc").decode().splitlines():
            words = line.split()
            if len(words) == 2 and not words[0].lstrip("-").isdigit():
                head[words[0]] = float(words[1])
            else:
                cells.append([float(word) for word in words])
        tap.equal((len(cells), len(cells[0]), head["NODATA_value"]), (head["nrows"], head["ncols"], -9999), "size")
        worst = holes = 0
        for row, line in enumerate(cells):
            north = head["yllcorner"] + (head["nrows"] - row - 0.5) * head["cellsize"]
            for column, depth in enumerate(line):
                east = head["xllcorner"] + (column + 0.5) * head["cellsize"]
                if depth == -9999:
                    holes += 1
                    tap.equal((east < -12, north < -12), (True, True), f"a hole at {north} north, {east} east")
                else:
                    worst = max(worst, abs(depth - (12 - (east + 20) / 2)))
        tap.equal(worst < 0.002, True, f"{worst} m beside the grid")
        # Three squares of 16 m2, and half of one of which three corners are known.
        tap.equal(abs(holes * head["cellsize"] ** 2 - 56) < 1, True, f"{holes} cells")


def test_terrain_in_gdal_and_outlines_in_sqlite():
    """A sea floor that falls from 8 to 18 m towards the north, 60 m by 60 m."""
    with Folder() as folder:
        rows = "\n".join(" ".join([str(18 - i / 3)] * 31) for i in range(31))
        folder.write("floor.asc", "ncols 31\nnrows 31\nxllcenter -30\nyllcenter -30\n"
                     f"cellsize 2\nNODATA_value -9999\n{rows}\n")
        run = run_of(folder, pings=2, edits={
            "bottom: {depth_m: 12, type: sand}": "bottom: {grid: {file: floor.asc}, type: sand}",
            "fan]": "fan, overview, plan]"})
        out = tool("gdalinfo", "-mm", "terrain.asc", cwd=run)
        low, high = map(float, re.search(r"Computed Min/Max=([\d.]+),([\d.]+)", out).groups())
        if abs(low - 8) > 0.2 or abs(high - 18) > 0.2:
            raise AssertionError((low, high))
        tap.contains(out, "NoData Value=-9999")
        # x east, y north: it is deeper in the north, as the scene's grid was.
        north = tool("gdallocationinfo", "-valonly", "-geoloc", "terrain.asc", "0", "25.05", cwd=run)
        tap.equal(round(float(north), 1), 17.2, "depth at 25 m north")
        out = tool("sqlite3", "-csv", ":memory:", cwd=run, stdin=(
            ".mode csv\n.import objects.csv o\nSELECT object, min(CAST(x_m AS REAL)), "
            "max(CAST(x_m AS REAL)), max(CAST(y_m AS REAL)) FROM o GROUP BY object;\n"))
        tap.equal(out.strip(), "ball,19.0,21.0,1.0", "the ball from above")
        tap.equal([n for n in pictures(folder, "r") if "_" not in n],
                  [n for n in ("overview.png", "plan.png") if "ascope_0.png" in
                   pictures(folder, "r")], "pictures")
        for name in ("terrain.asc", "objects.csv"):
            before = data(folder, "r", name)
            asdic("run", folder / "pool.yaml", "-o", folder / "p", "--pings", "0:1",
                  "--force").check(code=0)
            tap.equal(data(folder, "p", name), before, "of the whole mission")
        os.remove(folder / "floor.asc")  # pictures need the run folder alone
        before = {n: data(folder, "r", n) for n in pictures(folder, "r")}
        asdic("render", run).check(code=0)
        tap.equal({n: data(folder, "r", n) for n in pictures(folder, "r")} == before, True, "again")
        with open(run + "/terrain.asc", "a", encoding="ascii") as file:
            file.truncate(500)
        tap.contains(asdic("render", run).check(code=3).err, "damaged")


tap.main(globals())

"""What asdic run writes, read back by programs that are not ours. A test is skipped where its
program is not installed; `./dev test` installs them."""
import csv
import hashlib
import json
import math
import os
import re
import shutil
import subprocess
import tempfile
import xml.etree.ElementTree

import program
import tap
from program import Folder, asdic
from run_folder import data, facts, pictures, same, scene, png_texts
from svg_layout import check_layout, svg_marks

SYSTEM_PYTHON = "/usr/bin/python3"  # Debian's, which has Debian's numpy


def tool(*arguments, cwd, stdin=""):
    """Standard output of a foreign program, which must be content."""
    if not shutil.which(arguments[0]):
        raise tap.Skip(f"no {arguments[0]}")
    done = subprocess.run(arguments, cwd=cwd, input=stdin, capture_output=True, text=True,
                          timeout=60, check=False, env={**os.environ, "LC_ALL": "C"})
    if done.returncode:
        raise AssertionError(f"{arguments}: {done.returncode}: {done.stderr or done.stdout}")
    return done.stdout


def numpy(script, cwd, also=""):
    """Output of SCRIPT in a Python that has numpy and ALSO, "xarray, ..."."""
    modules = "numpy" + (", " + also if also else "")
    done = subprocess.run([SYSTEM_PYTHON, "-c", f"import sys\ntry:\n import {modules}\n"
                           "except ImportError:\n sys.exit(77)\n" + script],
                          cwd=cwd, capture_output=True, text=True, timeout=60, check=False)
    if done.returncode == 77:
        raise tap.Skip("no " + modules)
    if done.returncode:
        raise AssertionError(done.stderr)
    return done.stdout


KEPT = tempfile.TemporaryDirectory(prefix="asdic-test-")  # pylint: disable=consider-using-with


def run_of(folder, pings=4, **changes):
    """A run 'r' of the pool, all formats; its levels from bins.csv in file order. Made once, and copied where it is
    asked for again."""
    program.need_device()
    path = scene(folder, pings=pings, rays=500)
    text = folder.read("pool.yaml")
    for old, new in changes.get("edits", {"{npy: true,": "{npy: true, netcdf: true,"}).items():
        tap.contains(text, old)
        text = text.replace(old, new)
    folder.write("pool.yaml", text)
    kept = os.path.join(KEPT.name, hashlib.sha256(text.encode()).hexdigest())
    if not os.path.exists(kept):
        make_run(folder, path, text)
        shutil.copytree(folder / "r", kept + "/r")
        shutil.copy(path, kept)
    shutil.copy(kept + "/pool.yaml", path)
    shutil.copytree(kept + "/r", folder / "r", dirs_exist_ok=True)
    return folder / "r"


def make_run(folder, path, text):
    done = asdic("run", path, "-o", folder / "r")
    if "this build has no netCDF" in done.err:
        folder.write("pool.yaml", text.replace("netcdf: true, ", "").replace(", netcdf: true", ""))
        done = asdic("run", path, "-o", folder / "r")
    elif "netcdf: true" in text:
        tap.equal(os.path.exists(folder / "r/run.nc"), True, "run.nc")
    done.check(code=0)


def netcdf_run_of(folder, **changes):
    run = run_of(folder, **changes)
    if not os.path.exists(run + "/run.nc"):
        raise tap.Skip("built without netCDF")
    return run


def rows_of(folder):
    return list(csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines()))


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
        out = numpy("p = numpy.load('pings.npy'); q = numpy.load('levels.npy')\n"
                    "assert numpy.array_equal(p['level_db'], q, equal_nan=True)\n"
                    "assert q.dtype == numpy.float32, q.dtype\n"
                    "assert p['time_s'].tolist() == [0, 0.05, 0.1, 0.15], p['time_s']\n"
                    "assert p['ping'].tolist() == [0, 1, 2, 3]\n"
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
                     'beam = "forward", "down" ;', ':Conventions = "CF-1.7" ;',
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


def test_shards_give_the_same_netcdf():
    with Folder() as folder:
        netcdf_run_of(folder)
        for k in (1, 2):
            asdic("run", folder / "pool.yaml", "-o", folder / f"part{k}", "--shard",
                  f"{k}/2").check(code=0)
        asdic("merge", folder / "part1", folder / "part2", "-o", folder / "whole").check(code=0)
        tap.equal(data(folder, "whole", "run.nc") == data(folder, "r", "run.nc"), True, "run.nc")


def test_pictures_in_pngcheck_and_gdal():
    with Folder() as folder:
        run = run_of(folder)
        asdic("render", run, "--raw", "--db-range", "0:200").check(code=0)
        names = pictures(folder, "r")
        tap.contains(names, "raw_down.png")
        for name in names:
            tap.contains(tool("pngcheck", name, cwd=run), "OK: " + name)
        out = tool("gdalinfo", "-mm", "raw_down.png", cwd=run)
        tap.contains(out, f"Size is {facts(folder, 'r')['bins']}, 4")
        tap.contains(out, "Type=UInt16")
        levels = [float(r["level_db"]) for r in rows_of(folder)
                  if r["beam"] == "down" and r["level_db"]]
        found = re.search(r"Computed Min/Max=([\d.]+),([\d.]+)", out).groups()
        for grey, level in zip(map(float, found), (min(levels), max(levels))):
            if not 0 < level < 200 or abs(grey - (1 + 65534 * level / 200)) > 1:
                raise AssertionError((grey, level))


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


def render_bytes(run, *arguments):
    """What render writes to the standard output."""
    return subprocess.run([program.PATH, "render", run, *arguments, "-o", "-"], check=True,
                          capture_output=True, timeout=60).stdout


def pixels(folder, run, name):
    """A PNG file without its texts."""
    content, at, found = data(folder, run, name), 8, b""
    while at < len(content):
        length = int.from_bytes(content[at:at + 4], "big")
        found += content[at + 8:at + 8 + length] if content[at + 4:at + 8] == b"IDAT" else b""
        at += 12 + length
    return found


def test_levels_alone_tell_noise_from_echoes():
    """The error that a run states, and what its overview leaves white, hang on the noise, which records of levels
    do not keep. One run hears much, the other nothing."""
    with Folder() as folder:
        for level_db in (200, 100):
            for records in ("full", "levels"):
                loud = f"source_level_db: {level_db}\n  speckle: rayleigh"
                run = run_of(folder, edits={"source_level_db: 200": loud,
                                            "fan]": f"overview], records: {records}"})
                os.rename(run, folder / f"{records}{level_db}")
        full, levels = (facts(folder, f"{records}200")["stderr_db"]["rms"] for records in ("full", "levels"))
        tap.equal(abs(levels / full - 1) < 0.1, True, f"errors {full} dB with all parts, {levels} dB with levels")
        tap.equal(facts(folder, "levels100")["stderr_db"]["rms"], None, "an error where nothing is heard")
        if "overview.png" not in pictures(folder, "full100"):
            raise tap.Skip("built without cairo")
        tap.equal(pixels(folder, "levels100", "overview.png") == pixels(folder, "full100", "overview.png"), True,
                  "the same overview")
        before = data(folder, "levels100", "overview.png")
        asdic("render", folder / "levels100").check(code=0)
        tap.equal(data(folder, "levels100", "overview.png") == before, True, "the same overview drawn again")


def test_a_plan_shows_beams_that_are_no_fan():
    """Nine beams all round have the same areas in whatever order they are listed."""
    with Folder() as folder:
        for name, order in (("r1", (4, 8, 0, 3, 7, 2, 6, 1, 5)), ("r2", (0, 5, 1, 2, 8, 4, 7, 3, 6))):
            beams = "".join(f"\n    - {{name: b{i}, pitch_deg: 30, yaw_deg: {40 * i - 160}}}" for i in order)
            run = run_of(folder, pings=1, edits={"\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": beams,
                                                 "[waterfall, ascope, fan]": "[plan]",
                                                 "level_db: 200": "level_db: 0"})  # no error to note
            os.rename(run, folder / name)
        if not pictures(folder, "r1"):
            raise tap.Skip("built without cairo")
        tap.equal(pixels(folder, "r1", "plan.png") == pixels(folder, "r2", "plan.png"), True, "the same plan")


def test_a_plan_joins_beams_that_touch():
    """Two groups of six astern, no fan, of which each makes one area; twelve areas where gaps are between all."""
    for step, areas in (6, 2), (8, 12):
        with Folder() as folder:
            bearings = [(group + step * k + 180) % 360 - 180 for group in (130, 190) for k in range(6)]
            beams = "".join(f"\n    - {{name: b{k}, pitch_deg: 30, yaw_deg: {bearing}, length_h_m: 0.1}}"
                            for k, bearing in enumerate(bearings))
            run = run_of(folder, pings=1, edits={"\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": beams,
                                                 "[waterfall, ascope, fan]": "[plan]"})
            if not pictures(folder, "r"):
                raise tap.Skip("built without cairo")
            text = render_bytes(run, "--images", "plan", "--format", "svg").decode()
            drawn = re.findall(r'<path style="[^"]*fill:rgb\(0%,44[^"]*fill-opacity:0.2', text)
            tap.equal(len(drawn), areas, f"areas of beams {step} degrees apart")


def test_one_picture_goes_to_a_file_or_standard_output():
    with Folder() as folder:
        run = run_of(folder)
        names = pictures(folder, "r")
        tap.equal(render_bytes(run, "--images", "waterfall", "--beam", "down"),
                  data(folder, "r", "waterfall_down.png"), "the waterfall on standard output")
        tap.equal(render_bytes(run, "--raw", "--beam", "down")[16:29],
                  facts(folder, "r")["bins"].to_bytes(4, "big") + b"\0\0\0\4\x10\0\0\0\0", "raw")
        asdic("render", run, "--images", "waterfall", "--beam", "down", "-o",
              folder / "w.png").check(code=0, out="")
        tap.contains(asdic("render", run, "--images", "waterfall", "--beam", "down", "-o",
                           folder / "w.png").check(code=1).err, "--force")
        asdic("render", run, "--images", "waterfall", "--beam", "down", "-o", folder / "w.png",
              "--force").check(code=0)
        tap.contains(asdic("render", run, "-o", "-").check(code=2, out="").err, "these are")
        asdic("render", run, "--images", "ascope", "-o", "-").check(code=2, out="")
        asdic("render", run, "--format", "jpg").check(code=2)
        waterfall = "render", run, "--images", "waterfall", "--beam", "down"
        tap.contains(asdic(*waterfall, "-o", folder / "w.jpg").check(code=2, out="").err,
                     "w.jpg: a picture is a file in .png, .pdf or .svg")
        for name, options, begins in (("w.PDF", (), b"%PDF"), ("w.Svg", (), b"<?xml"), ("W.PNG", (), b"\x89PNG"),
                                      ("w.v2/w", (), b"\x89PNG"), ("w.jpg", ("--format", "svg"), b"<?xml")):
            os.makedirs(folder / "w.v2", exist_ok=True)
            asdic(*waterfall, "-o", folder / name, *options).check(code=0, out="")
            tap.equal(data(folder, ".", name)[: len(begins)], begins, name)
        tap.contains(asdic(*waterfall, "--raw", "-o", folder / "r.PDF").check(code=2, out="").err, "PNG")
        for vector in (("-o", folder / "raw.pdf"), ("-o", folder / "raw.svg"), ("-o", "-", "--format", "svg")):
            tap.contains(asdic("render", run, "--raw", "--beam", "down", *vector).check(code=2, out="").err, "PNG")
        os.symlink("/dev/full", folder / "full")  # a link: no slip may replace the device itself
        asdic("render", run, "--images", "waterfall", "--beam", "down", "-o",
              folder / "full").check(code=1)
        tap.equal(pictures(folder, "r"), names, "pictures of the run")


def test_a_video_shows_fans_and_leaves_no_parts():
    with Folder() as folder:
        run = run_of(folder, pings=2)
        if "ascope_0.png" not in pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        before = sorted(os.listdir(folder.path))
        for images, code, why in (("waterfall", 2, "--video is of '--images fan'"),
                                  ("fan", 2, "three beams or more"), ("ascope", 1, "did not write")):
            # An ffmpeg that fails; the run's two beams are no fan.
            os.makedirs(folder / "bin", exist_ok=True)
            folder.write("bin/ffmpeg", '#!/bin/sh\necho "$@" >"$0.args"\nexit 3\n')
            os.chmod(folder / "bin/ffmpeg", 0o755)
            tap.contains(asdic("render", run, "--video", folder / "v.mp4", "--images", images,
                               PATH=folder / "bin").check(code=code).err, why)
        tap.contains(folder.read("bin/ffmpeg.args"), " -framerate 20000/1000 ")  # the run's own time
        asdic("render", run, "--video", "x:1.mp4", "--images", "ascope", cwd=folder.path,
              PATH=folder / "bin").check(code=1)
        tap.contains(folder.read("bin/ffmpeg.args"), " file:x:1.part.mp4\n")  # a colon begins no protocol
        tap.equal(sorted(set(os.listdir(folder.path)) - {"bin"}), before, "nothing is left")
        # One that keeps what it gets.
        folder.write("bin/ffmpeg", '#!/bin/sh\nfor last; do :; done\nexec /bin/cat >"${last#file:}"\n')
        asdic("render", run, "--video", folder / "v.mp4", "--images", "ascope",
              PATH=folder / "bin").check(code=0, out="")
        tap.equal(data(folder, "", "v.mp4").count(b"\x89PNG\r\n"), 2, "pictures of two pings")
        tap.equal(sorted(set(os.listdir(folder.path)) - {"bin", "v.mp4"}), before, "no part is left")
        os.remove(folder / "v.mp4")
        shutil.rmtree(folder / "r")
        fan = "  receivers:\n    fan: {count: 12, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.05}"
        run_of(folder, pings=2, edits={"  receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                                       fan})
        if not shutil.which("ffmpeg") or not shutil.which("ffprobe"):
            raise tap.Skip("no ffmpeg")
        asdic("render", run, "--video", folder / "v.mp4").check(code=0, out="")
        tap.equal(tool("ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames",
                       "-of", "csv=p=0", "v.mp4", cwd=folder.path).strip(), "2", "frames")


def test_a_video_is_a_file_with_an_ending():
    for name in "-", "", "video", "a.b/video", "video.":
        done = asdic("render", "nowhere", "--video", name).check(code=2, out="")
        tap.contains(done.err, f"--video '{name}': a file, by whose ending ffmpeg knows")


def test_a_video_has_a_frame_for_each_ping():
    with Folder() as folder:
        run = run_of(folder)
        if "ascope_0.png" not in pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        names = pictures(folder, "r")
        done = asdic("render", run, "--video", folder / "v.mp4", "--images", "ascope",
                     PATH=folder.path).check(code=1)
        tap.contains(done.err, "a video needs ffmpeg")
        asdic("render", run, "--video", folder / "v.mp4", "--ping", "1").check(code=2)
        done = asdic("render", run, "--video", folder / "v.mp4", "--images", "fan").check(code=2)
        tap.contains(done.err, "error: none of the pictures asked for can be drawn of this run")
        tap.lacks(done.err, "ffmpeg")
        if not shutil.which("ffmpeg") or not shutil.which("ffprobe"):
            raise tap.Skip("no ffmpeg")
        asdic("render", run, "--video", folder / "v.mp4", "--images", "ascope").check(code=0, out="")
        facts_of = tool("ffprobe", "-v", "error", "-count_frames", "-show_entries",
                        "stream=nb_read_frames,r_frame_rate", "-of", "csv=p=0", "v.mp4",
                        cwd=folder.path)
        tap.equal(facts_of.strip(), "20/1,4", "frames a second, frames")
        tap.contains(asdic("render", run, "--video", folder / "v.mp4", "--images",
                           "ascope").check(code=1).err, "--force")
        tap.equal(pictures(folder, "r"), names, "pictures of the run")


def mosaic_of(folder, fan, pings):
    """The run of so many pings with that FAN, and m.png beside it in cells of half a metre."""
    run = run_of(folder, pings=pings, edits={
        "  receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": "  receivers: {fan: {" + fan + "}}"})
    asdic("render", run, "--mosaic", folder / "m.png", "--cell", "0.5").check(code=0, out="")
    return run


def test_a_mosaic_lies_where_it_says():
    """A ball 20 m north of a vehicle that looks north: the brightest place of its floor."""
    with Folder() as folder:
        run = mosaic_of(folder, "count: 64, sector_deg: 90, length_h_m: 0.5, length_v_m: 0.05", pings=2)
        world = [float(line) for line in data(folder, "", "m.pgw").decode().split()]
        reach = facts(folder, "r")["bins"]
        ways = [0.25 + 0.5 * k - reach for k in range(4 * reach)]  # to places, by their rows and columns
        seen = [(north, east) for north in ways for east in ways
                if north > abs(east) and math.hypot(north, east, 7) < reach]
        tap.equal(world, [0.5, 0, 0, -0.5, min(east for _, east in seen), max(north for north, _ in seen)], "world file")
        said = png_texts(data(folder, "", "m.png"))
        low, high = float(said["db_low"]), float(said["db_high"])
        tap.equal((low % 10, high % 10, low < high), (0, 0, True), f"window {low} to {high} dB")
        asdic("render", run, "--mosaic", folder / "gain.png", "--tvg", "20", "--colormap", "gray").check(code=0)
        given = png_texts(data(folder, "", "gain.png"))
        tap.equal((said["colormap"], given["colormap"]), ("viridis", "gray"))
        tap.equal(said["gain"].replace("30 log", "20 log"), given["gain"], "gain")
        tap.contains(asdic("render", run, "--mosaic", folder / "m.png").check(code=1).err, "--force")
        os.remove(folder / "m.png")  # the world file alone: as much someone's as the picture
        tap.contains(asdic("render", run, "--mosaic", folder / "m.png").check(code=1).err, "'%s' exists; --force" %
                     (folder / "m.pgw"))
        tap.equal("m.png" in folder.names(), False, "a mosaic beside another's world file")
        os.mkdir(folder / "r.1")  # a name's ending is not its folder's
        asdic("render", run, "--mosaic", folder / "r.1/a", "--cell", "0.5").check(code=0, out="")
        tap.equal(sorted(os.listdir(folder / "r.1")), ["a", "a.pgw"], "a mosaic in a folder with a point")
        asdic("render", run, "--mosaic", folder / "m.png", "--cell", "0.5", "--force").check(code=0, out="")
        if not shutil.which("gdallocationinfo"):
            raise tap.Skip("no gdal")
        def brightness(east, north):
            text = tool("gdallocationinfo", "-valonly", "-geoloc", "m.png", str(east), str(north),
                        cwd=folder.path)
            return sum(map(int, text.split()))
        if brightness(-15, 2) != 3 * 255:
            raise AssertionError("abeam of the vehicle nothing was seen")
        if brightness(0, 19.2) <= brightness(6, 19.2):
            raise AssertionError("the ball is brighter than the floor beside it")


def test_a_mosaic_is_the_mean_of_its_pings():
    """Cell by cell: the mean of the intensities, with gain, of the bins that lie there, of pings under way on two
    headings, rolled and pitched. The beams of a fan in one plane are bearings in that plane, those of a cone about
    the sonar's z axis; of a level fan these are the same."""
    for pitch_deg, shape in (0, "plane"), (30, "plane"), (30, "cone"):
        check_mean(pitch_deg, shape)


def check_mean(pitch_deg, shape):
    tilt_deg = pitch_deg if shape == "plane" else 0
    with Folder() as folder:
        folder.write("way.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,3,26,5,6,-4,0\n0.05,3,28,4,6,-4,20\n"
                     "0.1,5,37,4,-8,5,110\n")
        run = run_of(folder, pings=3, edits={
            "  receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                f"  receivers: {{fan: {{count: 12, sector_deg: 96, pitch_deg: {pitch_deg}, shape: {shape}, "
                "length_h_m: 0.2, length_v_m: 0.02}}\n  max_range_m: 30",
            "mission: {pose: {position_m: [0, 0, 5]}": f"mission: {{track: {folder / 'way.csv'}"})
        asdic("render", run, "--mosaic", folder / "m.png", "--cell", "0.8", "--colormap", "gray").check(code=0, out="")
        said = asdic("model", "absorption", "t_degc=10", "s_ppt=35", "z_m=5", "ph=8", "f_khz=100").check(code=0).out
        alpha = float(re.search(r"[-+.0-9e]+(?= dB/km)", said)[0])
        texts = png_texts(data(folder, "", "m.png"))
        numpy(f"""
import numpy as np
from PIL import Image
pings, cell, reach = np.load("r/pings.npy"), 0.8, 30.0
assert len(pings) == 3 and pings["level_db"].shape[1:] == (12, 30), pings["level_db"].shape
x, y, z = pings["position_m"].T
south, west = x.min() - reach, y.min() - reach
rows, columns = int(np.ceil((x.max() + reach - south) / cell)), int(np.ceil((y.max() + reach - west) / cell))
north = south + (np.arange(rows)[::-1, None] + 0.5) * cell + np.zeros((rows, columns))
east = west + (np.arange(columns) + 0.5) * cell + np.zeros((rows, columns))
total, count, clear = np.zeros((rows, columns)), np.zeros((rows, columns), int), np.ones((rows, columns), bool)
for p in pings:
    way = np.stack([north - p["position_m"][0], east - p["position_m"][1],
                    np.full((rows, columns), 12.0 - p["position_m"][2])], axis=-1)
    r = np.linalg.norm(way, axis=-1)
    roll, pitch, yaw = p["attitude_rad"]
    ahead = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
    level = np.array([-np.sin(yaw), np.cos(yaw), 0.0])  # to starboard, before the roll
    starboard = np.cos(roll) * level + np.sin(roll) * np.cross(ahead, level)
    tilt = np.radians({tilt_deg})
    ahead = np.cos(tilt) * ahead + np.sin(tilt) * np.cross(ahead, starboard)
    beam = (np.degrees(np.arctan2(way @ starboard, way @ ahead)) + 48.0) / 8.0
    seen = (r < reach) & (beam > 0) & (beam < 12)
    clear &= (abs(r - np.rint(r)) > 1e-4) & (abs(beam - np.rint(beam)) > 1e-4)
    db = p["level_db"][np.clip(beam, 0, 11).astype(int), np.clip(r, 0, 29).astype(int)].astype(float)
    seen &= np.isfinite(db)
    total += np.where(seen, 10 ** (0.1 * (db + 30 * np.log10(r) + 2 * {alpha} * r / 1000)), 0.0)
    count += seen
assert (count > 1).sum() > 500, np.bincount(count.ravel())
with np.errstate(all="ignore"):
    shown = 10 * np.log10(total / count)
ordered = np.sort(shown[count > 0])
low, high = 10 * np.floor(ordered[len(ordered) // 20] / 10), 10 * np.ceil(ordered[len(ordered) * 995 // 1000] / 10)
assert (low, high) == ({texts["db_low"]}, {texts["db_high"]}), (low, high)
picture = np.array(Image.open("m.png").convert("RGB")).astype(int)
wanted = np.where(count > 0, 255 * np.clip((shown - low) / (high - low), 0, 1), 255)
box = tuple(slice(at.min(), at.max() + 1) for at in np.nonzero(count))  # the picture ends where nothing was seen
assert picture.shape == (*wanted[box].shape, 3) and wanted[box].size < 0.8 * count.size, picture.shape
off = abs(picture[..., 0] - wanted[box])[clear[box]]
assert clear.mean() > 0.95 and off.max() < 1.5, (clear.mean(), off.max(), (off > 1.5).mean())
""", folder / ".", "PIL")


def test_a_mosaic_goes_without_what_it_cannot_follow():
    """Before the run is looked at: there is none."""
    with Folder() as folder:
        for others in (("--mosaic", "m.png", "--beam", "down"), ("--mosaic", "m.png", "--ping", "1"),
                       ("--mosaic", "m.png", "--images", "plan"), ("--mosaic", "m.png", "--raw"),
                       ("--mosaic", "m.png", "--format", "png"), ("--mosaic", "m.png", "-o", "o.png"),
                       ("--mosaic", "m.png", "--video", "v.mp4"), ("--mosaic", "m.pdf"), ("--mosaic", "-"),
                       ("--cell", "1"), ("--cell", "1", "--video", "v.mp4")):
            tap.contains(asdic("render", "r", *others, cwd=folder.path).check(code=2, out="").err, "--mosaic")
        tap.equal(folder.names(), [], "files that were written")


def test_a_mosaic_of_a_fan_that_looks_astern():
    """Both halves of its floor, beyond 180 degrees as well."""
    with Folder() as folder:
        mosaic_of(folder, "count: 4, sector_deg: 120, yaw_deg: 180", pings=1)
        yaws = [0, 90, 115, 125, 150, 178, 182, 200, 235, 245, 270]
        places = "".join(f"{20 * math.sin(math.radians(y))} {20 * math.cos(math.radians(y))}\n" for y in yaws)
        out = tool("gdallocationinfo", "-valonly", "-b", "1", "-geoloc", "m.png", cwd=folder.path,
                   stdin=places).splitlines()  # empty beyond the picture
        tap.equal([yaw for yaw, value in zip(yaws, out) if value not in ("", "255")], [125, 150, 178, 182, 200, 235],
                  "bearings that were seen")


STEP = """version: 1
bottom: {mesh: {file: step.ply}, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 0.5}, position_m: [20, 0, 13.5], material: {impedance_mrayl: 45}}
sonar:
  frequency_khz: 300
  ping_rate_hz: 18
  source_level_db: 200
  bin_length_m: 0.25
  transmitter: {length_h_m: 0.004, length_v_m: 0.006}
  receivers:
    fan: {count: 64, sector_deg: 90, length_h_m: 0.15, length_v_m: 0.006}
mission: {pose: {position_m: [0, 0, 10], roll_deg: 5, pitch_deg: -10}, pings: 2}
sampling: {rays: 20000}
output: {csv: none, images: []}
"""


def test_a_mosaic_lies_on_the_terrain():
    """A ball on a floor 4 m below a vehicle that flies 12 m above a lower one: its near side, 19.8 m
    away, lies 19.4 m north on the upper floor and would lie 15.7 m north on the lower one."""
    program.need_device()
    with Folder() as folder:
        corners = [(x, y, z) for y, z in ((-60, -22), (10, -22), (10, -14), (60, -14)) for x in (-60, 60)]
        sides = [(2 * i + a, 2 * i + b, 2 * i + c) for i in range(3) for a, b, c in ((0, 1, 3), (0, 3, 2))]
        folder.write("step.ply", "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\n"
                     "property float y\nproperty float z\nelement face 6\nproperty list uchar int "
                     "vertex_index\nend_header\n" + "".join("%g %g %g\n" % c for c in corners) +
                     "".join("3 %d %d %d\n" % s for s in sides))
        asdic("run", folder.write("step.yaml", STEP), "-o", folder / "r").check(code=0)
        asdic("render", folder / "r", "--mosaic", folder / "m.png", "--colormap", "gray").check(code=0, out="")
        norths = [16.5 + 0.25 * i for i in range(30)]
        places = "".join(f"{east} {north}\n" for east in (0, 3) for north in norths)
        out = tool("gdallocationinfo", "-valonly", "-b", "1", "-geoloc", "m.png", cwd=folder.path,
                   stdin=places)
        grey = list(map(int, out.split()))
        ball, beside = grey[:len(norths)], grey[len(norths):]
        bright = [n for n, g in zip(norths, ball) if g == max(ball)]
        if max(ball) <= max(beside) or not all(abs(n - 19.4) < 0.75 for n in bright):
            raise AssertionError((bright, ball, beside))


LINE = """version: 1
environment: {sound_speed_mps: 1500, wind_speed_kn: 0}
bottom: {depth_m: 12, type: mud}
objects:
  - {name: right, point: {target_strength_db: 20}, position_m: [8, 9, 11.9]}
  - {name: left, point: {target_strength_db: 20}, position_m: [10, -5, 11.9]}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  source_level_db: 200
  bin_length_m: 0.075
  max_range_m: 20
  transmitter: {length_h_m: 0.01, length_v_m: 0.01}
  array: {elements: 64, spacing_wl: 0.5, element: {length_v_m: 0.01}, beams: {count: 128, sector_deg: 120}}
mission: {pose: {position_m: [0, 0, 7], roll_deg: 4}, pings: 1}
sampling: {coherent: true, rays: 1000}
output: {csv: none, images: []}
"""


def test_a_mosaic_of_a_line_of_elements():
    """Its beams are cones about it: 20 degrees down and 48 aside a point is heard by the beam at 44 degrees. Laid as a fan of
    upright beams it would be 0.9 m off."""
    program.need_device()
    with Folder() as folder:
        asdic("run", folder.write("line.yaml", LINE), "-o", folder / "r").check(code=0)
        asdic("render", folder / "r", "--mosaic", folder / "m.png", "--cell", "0.1", "--colormap", "gray",
              "--db-range", "0:300").check(code=0, out="")
        for north, east in (8, 9), (10, -5):
            near = [(x / 10, y / 10) for x in range(-15, 16) for y in range(-15, 16)]
            out = tool("gdallocationinfo", "-valonly", "-b", "1", "-geoloc", "m.png", cwd=folder.path,
                       stdin="".join(f"{east + x} {north + y}\n" for x, y in near))
            levels = [0 if level == "255" else int(level) for level in out.split()]  # white: nothing was heard
            peak = [at for at, level in zip(near, levels) if level == max(levels)]
            middle = [sum(at[k] for at in peak) / len(peak) for k in (0, 1)]
            if math.hypot(*middle) > 0.2:
                raise AssertionError((north, east, middle, peak))


def test_ascope_says_how_many_beams_it_leaves_out():
    with Folder() as folder:
        more = "".join(f"\n    - {{name: more{i}, pitch_deg: {9 * i}}}" for i in range(3))
        down = "    - {name: down, pitch_deg: 45}"
        run_of(folder, pings=1, edits={down: down + more})
        tap.contains(data(folder, "r", "ascope_0.png").decode("latin-1"), "t = 0 s, 4 of 5 beams")


def test_beams_that_look_down_make_a_section():
    with Folder() as folder:
        run_of(folder, pings=2, edits={"  receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                                       "  receivers: {fan: {count: 13, sector_deg: 120, pitch_deg: 90}}"})
        found = pictures(folder, "r")
        for name in ("fan_0.png", "fan_1.png", "waterfall_006.png"):
            if name not in found:
                raise AssertionError((name, found))


def test_beams_straight_down_make_no_fan():
    """Their yaws ascend, and turn them about their own axis."""
    with Folder() as folder:
        beams = "".join(f"\n    - {{name: b{i}, pitch_deg: 90, yaw_deg: {20 * i - 40}}}" for i in range(5))
        run_of(folder, pings=1, edits={"\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": beams})
        tap.equal([name for name in pictures(folder, "r") if name.startswith("fan_")], [], "fan pictures")
        done = asdic("render", folder / "r", "--images", "fan").check(code=2)
        tap.contains(done.err, "no fan picture: it needs three beams or more at ascending bearings")
        tap.contains(done.err, "error: ")
        asdic("render", folder / "r", "--images", "fan,ascope").check(code=0)


def test_rings_of_fans_lie_at_their_ranges():
    with Folder() as folder:
        run = run_of(folder, edits={"receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                                    "receivers: {fan: {count: 9, sector_deg: 90, length_h_m: 0.1}}"})
        if not any(name.startswith("fan") for name in pictures(folder, "r")):
            raise tap.Skip("built without cairo")
        svg = render_bytes(run, "--images", "fan", "--ping", "0", "--format", "svg").decode()
        drawn = re.findall(r'stroke:rgb\(54\.5[^"]*" d="M ([\d.]+) ([\d.]+) ([CL])', svg)
        lines = [(float(x), float(y)) for x, y, kind in drawn if kind == "L"]
        sonar = max(lines, key=lines.count)  # both edges of the sector begin there
        radii = [math.dist(sonar, (float(x), float(y))) for x, y, kind in drawn if kind == "C"]
        said = facts(folder, "r")
        reach_m = said["bins"] * said["bin_length_m"]
        tap.equal(len(radii) > 2 and radii[0] > 300, True, f"the outermost, then the others: {radii}")
        metres = [radius * reach_m / radii[0] for radius in radii[1:]]
        tap.equal([m for k, m in enumerate(metres, 1) if abs(m - k * round(metres[0])) > 0.05], [], f"rings at {metres}")


def test_an_overview_names_up_to_sixteen_beams():
    """More of them have numbers on an axis."""
    words = {}
    for beams in 16, 17:
        with Folder() as folder:
            run = run_of(folder, pings=2, edits={
                "fan]": "overview]", "    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                f"    fan: {{count: {beams}, sector_deg: 90}}"})
            if "overview.png" not in pictures(folder, "r"):
                raise tap.Skip("built without cairo")
            svg = render_bytes(run, "--images", "overview", "--format", "svg").decode()
            words[beams] = len(svg_marks(svg)[1])
    tap.equal(words[16] >= words[17] + 8, True, f"{words} words")


def test_vector_pictures():
    with Folder() as folder:
        run = run_of(folder, edits={"fan]": "fan, overview, plan]"})
        if "plan.png" not in pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        stems = [name[:-4] for name in pictures(folder, "r")]
        digest = facts(folder, "r")["scene"]["sha256"].encode()
        asdic("render", run, "--format", "pdf").check(code=0)
        asdic("render", run, "--format", "svg").check(code=0)
        for stem in stems:
            content = data(folder, "r", stem + ".pdf")
            tap.equal((content[:5], b"%%EOF" in content[-8:], digest in content),
                      (b"%PDF-", True, True), stem)
            if not re.search(rb"/Keywords \((\w+: [^;)]+; )*\w+: [^;)]+\)", content):
                raise AssertionError(f"{stem}: no keywords")
            said = png_texts(data(folder, "r", stem + ".png"))
            if said["Title"].isascii():
                tap.equal(f"/Title ({said['Title']})".encode() in content, True, f"{stem}: {said['Title']}")
            if stem == "waterfall_down":
                for key in ("db_low", "db_high"):
                    tap.contains(content.decode("latin-1"), f"{key}: {said[key]}")
            root = xml.etree.ElementTree.fromstring(data(folder, "r", stem + ".svg"))
            tap.equal(root.tag, "{http://www.w3.org/2000/svg}svg", stem)
            check_layout(data(folder, "r", stem + ".svg").decode(), stem)
        root = xml.etree.ElementTree.fromstring(
            render_bytes(run, "--images", "plan", "--format", "svg"))
        tap.equal(root.tag, "{http://www.w3.org/2000/svg}svg", "on standard output")
        # Pictures in any format go when the run is replaced.
        asdic("run", folder / "pool.yaml", "-o", run, "--force").check(code=0)
        tap.equal([n for n in os.listdir(run) if n.endswith((".pdf", ".svg"))], [], "left over")


SVG = """
import csv, io, re
import numpy as np
text = open("x.svg").read()
paths = []  # colour, closed, corners
for style, d in re.findall(r'<path style="([^"]*)" d="([^"]*)"', text):
    found = re.search(r"stroke:rgb\\(([^)]*)\\)", style)
    if found:
        rgb = "".join("%02x" % round(2.55 * float(part[:-1])) for part in found[1].split(","))
        xy = np.array(re.findall(r"[ML] (\\S+) (\\S+)", d), float)
        paths.append((rgb, " Z" in d, xy))
"""


def test_ascopes_show_the_run():
    """Every curve of both beams, read from the vector picture: what was simulated, and what is expected."""
    with Folder() as folder:
        folder.write("way.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,5,0,0,0\n0.1,1,0,8,0,0,0\n")
        run = run_of(folder, pings=3, edits={
            "{name: down, pitch_deg: 45}": "{name: down, pitch_deg: 45, length_h_m: 0.2}",  # hears another noise
            "mission: {pose: {position_m: [0, 0, 5]}": f"mission: {{track: {folder / 'way.csv'}"})
        if "ascope_0.png" not in pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        window = png_texts(data(folder, "r", "ascope_2.png"))
        low, high = float(window["db_low"]), float(window["db_high"])
        asdic("render", run, "--images", "ascope", "--ping", "2", "--tvg", "30", "-o", folder / "x.svg").check(code=0)
        folder.write("e.csv", asdic("expect", folder / "pool.yaml", "--ping", "2", "-o", "-", "-q").check(code=0).out)
        numpy(SVG + f"""
low, high = {low}, {high}
record = np.load("r/pings.npy")[2]
bins = record["level_db"].shape[1]
assert low < high and np.nanmax(np.load("r/pings.npy")["level_db"]) < high - 1.9
rows = list(csv.DictReader(open("e.csv")))
frames = sorted((xy for rgb, closed, xy in paths if closed and len(xy) == 5 and np.ptp(xy[:, 0]) > 800),
                key=lambda xy: xy[:, 1].min())
assert len(frames) == 3, len(frames)  # the last is that of the differences
wanted = {{"e69f00": "noise_db", "009e73": "volume_db", "56b4e9": "surface_db", "0072b2": "bottom_db",
          "b4b4b4": "total_db", "000000": "level_db", "d55e00": "object_db"}}
for beam, (name, frame) in enumerate(zip(("forward", "down"), frames)):
    (left, top), (right, bottom) = frame.min(0) + 0.5, frame.max(0) - 0.5
    for rgb, column in wanted.items():
        if column in ("level_db", "object_db"):
            levels = record[column][beam].astype(float)
        else:
            levels = np.array([float(row[column] or "nan") for row in rows if row["beam"] == name])
        curves = [xy for colour, _, xy in paths if colour == rgb]
        x = left + (np.arange(bins) + 0.5) / bins * (right - left)
        y = bottom - (levels - low) / (high - low) * (bottom - top)
        there = np.isfinite(y) & (y > top + 1) & (y < bottom - 1)
        assert there.sum() >= (2 if column == "object_db" else 5), (name, column, there.sum())
        off = [min((abs(np.interp(u, *xy.T) - v) for xy in curves if -0.1 < u - xy[0, 0] < 0.2 + np.ptp(xy[:, 0])),
                   default=np.inf) for u, v in zip(x[there], y[there])]
        assert max(off) < 0.7, (name, column, max(off))
""", folder / ".")


def test_a_plan_shows_where_lobes_meet_the_bottom():
    """At the first, the middle and the last ping of a vehicle that swims east, 45 degrees down: from near edge to far
    one, and of a head that scans, over its sector round the bow."""
    said = asdic("model", "sound-speed", "t_degc=10", "s_ppt=35", "z_m=5").check(code=0).out
    wave = float(re.search(r"[-+.0-9e]+(?= m.s)", said)[0]) / 1e5
    for scan, pings in ("", 5), ("  scan: {sector_deg: 90, step_deg: 6}\n", 31):
        with Folder() as folder:
            folder.write("way.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,5,0,0,90\n10,0,500,5,0,0,90\n")
            run = run_of(folder, pings=pings, edits={
                "receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                    "receivers: [{name: down, pitch_deg: 45, length_h_m: 0.1, length_v_m: 0.08}]\n" + scan,
                "mission: {pose: {position_m: [0, 0, 5]}": f"mission: {{track: {folder / 'way.csv'}",
                "fan]": "fan, plan]"})
            if "plan.png" not in pictures(folder, "r"):
                raise tap.Skip("built without cairo")
            asdic("render", run, "--images", "plan", "-o", folder / "x.svg", "--force").check(code=0)
            numpy(SVG + f"""
half_v, half_h = (np.degrees(np.arcsin(0.442946 * {wave} / length)) for length in (0.08, 0.1))
[track] = [xy for rgb, closed, xy in paths if rgb == "d55e00" and len(xy) == 2 and xy[0, 1] > 100]
areas = [xy for rgb, closed, xy in paths if rgb == "0072b2" and len(xy) > 20]
scale = (track[1, 0] - track[0, 0]) / (2.5 * {pings - 1})
assert abs(track[1, 1] - track[0, 1]) < 0.1 and len(areas) == 3, len(areas)
near, far = (7 / np.tan(np.radians(45 + sign * half_v)) for sign in (1, -1))
sector = {45 if scan else 0} + half_h / np.cos(np.radians(45))
for place, area in enumerate(areas):
    east = (area[:, 0] - track[0, 0]) / scale - 2.5 * ({pings - 1} // 2 * place)
    south = (area[:, 1] - track[0, 1]) / scale
    r, bearing = np.hypot(east, south), np.degrees(np.arctan2(south, east))
    assert abs(r.min() - near) < 0.05 * near and abs(r.max() - far) < 0.05 * far, (place, r.min(), near, r.max(), far)
    assert max(abs(abs(bearing.min()) - sector), abs(bearing.max() - sector)) < 2, (place, bearing, sector)
""", folder / ".")


def test_bins_go_to_standard_output():
    with Folder() as folder:
        run_of(folder)
        done = asdic("run", folder / "pool.yaml", "-o", "-", cwd=folder.path).check(code=0)
        tap.equal(done.out.encode() == data(folder, "r", "bins.csv"), True, "bins.csv")
        tap.contains(done.err, "standard output: ")
        tap.equal(sorted(folder.names()), ["pool.yaml", "r"], "files")
        asdic("run", folder / "pool.yaml", "-o", "-", "--resume").check(code=2, out="")


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

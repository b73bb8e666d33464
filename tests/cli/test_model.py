"""asdic model: one line per value, the list, errors that help."""
import json
import struct

import tap
from program import asdic, need_device

MODELS = ["sound-speed", "absorption", "transmission-loss", "beam-pattern", "bottom-backscatter",
          "surface-backscatter", "volume-backscatter", "noise-turbulence", "noise-traffic",
          "noise-sea-state", "noise-thermal", "noise", "range-resolution", "max-range",
          "target-strength", "facet-strength", "pfa", "pd"]


def model(*args):
    return asdic("model", *args).check(code=0, err="").out


def test_value_and_unit():
    tap.equal(model("sound-speed", "t_degc=10", "s_ppt=35", "z_m=7"), "1490.102 m/s\n")
    tap.equal(model("range-resolution", "c_mps=1500", "bandwidth_hz=7500"), "0.1 m\n")
    tap.equal(model("pfa", "model=exponential", "threshold=0", "mu0=2"), "1 1\n")
    tap.equal(model("pfa", "model=exponential", "threshold=1", "mu0=3"), "0.716531310573789 1\n")  # of ...78928
    tap.equal(model("beam-pattern", "theta_deg=180", "psi_deg=0", "length_h_m=0.05",
                    "length_v_m=0.05", "wavelength_m=0.015"), "-inf dB\n")


def test_words_and_numbers_mean_the_same():
    keys = ("f_khz=100", "grazing_deg=30")
    tap.equal(model("bottom-backscatter", "type=sand", *keys),
              model("bottom-backscatter", "type=2", *keys))
    tap.equal(model("absorption", "f_khz=100", "t_degc=10", "s_ppt=35", "z_m=0", "ph=8"),
              model("absorption", "variant=corrected", "ph=8", "z_m=0", "s_ppt=35", "t_degc=10",
                    "f_khz=100"))


def test_device_agrees():
    need_device()
    args = ("surface-backscatter", "wind_kn=10", "f_khz=100", "grazing_deg=20")
    host = float(model(*args).split()[0])
    printed = model(*args, "--device", "auto").split()[0]
    device = float(printed)
    single = struct.unpack("f", struct.pack("f", device))[0]
    tap.equal(printed, f"{single:.9g}", "all digits of a float")
    if not 0 < abs(host - device) < 1e-3:  # single precision is not double precision
        raise AssertionError(f"{host} on the host, {device} on the device")


def test_list_has_every_name():
    text = model()
    for name in MODELS:
        tap.contains("\n" + text, f"\n{name}  ")
    listed = json.loads(model("--json"))
    names = [m["name"] for m in listed]
    tap.equal(names[:len(MODELS)], MODELS)
    tap.equal("rough-facet" in names[len(MODELS):], True, "laws without a formula of their own follow")
    tap.equal(len(set(names)), len(names), "names are there once")
    for m in listed:
        tap.equal(bool(m["source"] and m["unit"] and m["keys"]), True, m["name"])


def test_list_in_words_has_the_numbers_of_json():
    told = {block.split("  ")[0]: block.splitlines()[2:] for block in model().split("\n\n")}
    for info in json.loads(model("--json")):
        lines = {line.split()[0]: line for line in told[info["name"]]}
        for k in info["keys"]:
            line = lines[k["name"]]
            tap.equal(("default" in k, " (optional)" in line), (not k["required"],) * 2, k["name"])
            is_told = k.get("default") is not None
            tap.equal(", else " in line, is_told, f"{info['name']}, {k['name']}")
            if is_told:
                tap.contains(line, f", else {k['default']:.9g}" if "min" in k else ", else the first")
            if k.get("min") is None:
                continue
            tap.contains(line, f"[{k['min']:.9g}, {k['max']:.9g}]")
            valid = f", valid [{k['valid_min']:.9g}, {k['valid_max']:.9g}]"
            is_narrow = (k["valid_min"], k["valid_max"]) != (k["min"], k["max"])
            tap.equal(line[line.find(", valid"):] if ", valid" in line else "", valid if is_narrow else "",
                      f"{info['name']}, {k['name']}")


def test_no_formula_has_as_many_keys():
    most = 12  # as in the header
    for count, is_too_many in ((most, False), (most + 1, True)):
        done = asdic("model", "noise", *(f"a{i}=1" for i in range(count))).check(code=2, out="")
        tap.equal(f"{count} keys, more than any formula has" in done.err, is_too_many, done.err)


def test_json_value():
    value = json.loads(model("noise-thermal", "f_khz=100", "--json"))
    tap.equal((value["value"], value["unit"], value["device"]), (25.0, "dB", None))


def test_validity_is_warned_about_once():
    done = asdic("model", "bottom-backscatter", "type=sand", "f_khz=900", "grazing_deg=30")
    done.check(code=0)
    tap.equal(done.err.count("warning"), 1, "warnings")
    tap.contains(done.err, "[50, 400]")


def test_every_limit_warns_once():
    """Each formula with every key at its middle is silent; at each end of a domain that its source
    does not cover it warns, once."""
    warned = 0
    for info in json.loads(model("--json")):
        middle = {}
        for k in info["keys"]:
            if k["columns"]:
                middle = None  # a file has no limits of a source
                break
            if k["words"] and not k.get("min"):
                middle[k["name"]] = k["words"].split("|")[0]
            elif k["required"]:
                middle[k["name"]] = 0.5 * (k["valid_min"] + k["valid_max"])
        if middle is None:
            continue
        if info["name"] == "target-strength":
            middle["radius_m"], middle["f_khz"] = 1, 100

        def warnings(keys):
            done = asdic("model", info["name"], *(f"{k}={v}" for k, v in keys.items()))
            return done.check(code=0).err.count("warning")

        tap.equal(warnings(middle), 0, info["name"])
        for k in info["keys"]:
            for end in ("min", "max"):
                if k.get(end) is not None and k[end] != k["valid_" + end]:
                    tap.equal(warnings({**middle, k["name"]: k[end]}), 1, info["name"] + k["name"])
                    warned += 1
        outside = {k["name"]: k["max"] for k in info["keys"] if k.get("max") is not None
                   and k["max"] != k["valid_max"]}
        if len(outside) > 1:
            tap.equal(warnings({**middle, **outside}), 1, info["name"] + ", all at once")
    tap.equal(warned >= 15, True, f"{warned} ends outside their source's validity")


def test_errors_say_what_to_do():
    for args, parts in (
            (("absorbtion",), ("did you mean 'absorption'",)),
            (("sound-speed", "t_degc=1"), ("'s_ppt' is missing", "keys: t_degc s_ppt z_m")),
            (("sound-speed", "t_deg=1"), ("did you mean 't_degc'",)),
            (("sound-speed", "t_degc=abc"), ("'abc' is not a number",)),
            (("sound-speed", "t_degc=400"), ("400", "[-2, 40]")),
            (("sound-speed", "t_degc"), ("not key=value",)),
            (("sound-speed", "z_m=1", "z_m=2"), ("given twice",)),
            (("apl-bottom", "sediment=clay", "grain_size_phi=2", "f_khz=30", "grazing_deg=9", "c_mps=1500"),
             ("'sediment' and 'grain_size_phi' exclude each other",)),
            (("apl-bottom-loss", "sediment=peat", "f_khz=30", "grazing_deg=9", "c_mps=1500"),
             ("rough_rock|rock|cobble",)),
            (("pfa", "model=gauss"), ("exponential|k|swerling0",)),
            (("pfa", "model=k", "threshold=1", "mu0=1"), ("needs a shape",)),
            (("pfa", "model=k", "threshold=1", "mu0=1", "looks=2.5", "shape=2"), ("'looks' = 2.5 is not a whole number",)),
            (("target-strength", "shape=plate", "width_m=1"), ("'height_m' is missing",))):
        done = asdic("model", *args).check(code=2, out="")
        for part in parts:
            tap.contains(done.err, part)


def test_bodies_of_few_wavelengths_are_remarked():
    """2 pi a / wavelength = 10 at 15.9155 kHz and 1500 m/s, a = 0.15 m; a plate is judged by no radius."""
    small = "warning: target-strength: ka = 9.9; geometric optics is within 0.5 dB above 10 only\n"
    for shape, f_khz, said in (("shape=sphere radius_m=0.15", 15.75634, small), ("shape=sphere radius_m=0.15", 15.92, ""),
                               ("shape=plate width_m=0.1 height_m=0.1", 10, "")):
        done = asdic("model", "target-strength", *shape.split(), f"f_khz={f_khz}", "c_mps=1500").check(code=0)
        tap.equal(done.err, said, f"{shape} {f_khz}")


tap.main(globals())

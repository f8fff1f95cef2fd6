"""The page of `stiction lab` computes what the program computes, keeps fields, scene and link in step, and is used by keyboard, phone and screen reader."""

import base64
import json
import os
import signal
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest
from test_report import contrast

import stiction
from stiction import lab
from stiction.errors import FileError
from stiction.lab import command, server
from stiction.program import call

ROOT = Path(__file__).resolve().parents[3]
PAD = """material.youngs_modulus = "169 GPa"       # polysilicon, both surfaces
material.poisson_ratio = 0.22
material.hardness = "12 GPa"
material.work_of_adhesion = "20 mJ/m^2"   # dry or coated surfaces: 5 to 100 mJ/m^2
surface.asperity_radius = "100 nm"        # of summits; of two like surfaces R/√2 of one
surface.asperity_density = "100 /um^2"
surface.surface_height_std = "4 nm"       # rms roughness of both surfaces together
surface.nominal_area = "100 um^2"         # of one pad
model.history = "loop"                    # pressed together, then pulled apart
instability.preload = "100 uN"
device.restoring_force = "100 nN"
ensemble.replicas = {replicas}
"""
# Quickly computed: for what does not look at its numbers.
SMALL = PAD.format(replicas=8).replace('"100 um^2"', '"4 um^2"') + "ensemble.model_range = false\n"
SECONDS = 180


@pytest.fixture(scope="module")
def address():
    """The address of the page, served in this process."""
    if not server.CORE.is_file():
        pytest.skip("no python/stiction/lab/stiction.wasm, which scripts/lab.sh builds, so the page was not opened")
    with lab.Server() as serving:
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        yield serving.address
        serving.shutdown()


def waited(browser, script, *arguments):
    """What a script returns once that is true."""
    end = time.monotonic() + SECONDS
    while not (value := browser.execute_script(f"return {script}", *arguments)):
        assert time.monotonic() < end, (script, browser.find_element("css selector", "body").text)
        time.sleep(0.05)
    return value


@pytest.fixture
def opened(browser, address):
    """Opens the page with a scene, and waits until it is computed; returns the browser."""

    def open_page(scene=SMALL, width=1280, height=900, until="lab.isComplete"):
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        browser.get("about:blank")
        browser.get(address if scene is None else lab.link(address, scene))
        waited(browser, f"globalThis.lab && lab.toml && {until}")
        return browser

    yield open_page
    serious = [entry for entry in browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    browser.get("about:blank")
    assert serious == []


def of_page(browser):
    """What the page has computed, with NaN for what is no number."""
    found = browser.execute_script("return JSON.stringify([lab.results, lab.integral, lab.about, lab.pullOffs])")
    return json.loads(found)


def numbers(values):
    return np.array([np.nan if value is None else value for value in values])


def without_file(text):
    """A summary without the lines about its file."""
    return text.split("  written  ")[0].rstrip()


# Numbers.


@pytest.mark.parametrize("name", ["loop", "approach"])
def test_the_numbers_are_those_of_the_program_to_the_bit(opened, tmp_path, name):
    scene = PAD.format(replicas=20)
    if name == "approach":
        scene = scene.replace('"loop"', '"approach"').replace('instability.preload = "100 uN"\n', "")
    browser = opened(scene)
    results, integral, about, pull_offs = of_page(browser)
    path = tmp_path / "pad.toml"
    path.write_text(scene, encoding="utf-8")
    printed = call(["run", str(path), "-o", str(tmp_path / "pad.h5")])
    same = np.testing.assert_array_equal
    with h5py.File(tmp_path / "pad.h5") as file:
        same(numbers(of["whole"] for of in pull_offs), file["replicas/pull_off_force"])
        same(about["separations"], file["ensemble/separation"])
        prefixes = {"approach": "", "retraction": "retraction_"}
        assert [of["way"] for of in results["curves"]] == list(prefixes)[: 1 + (name == "loop")]
        for curve, path_of_integral in zip(results["curves"], integral["paths"], strict=True):
            prefix = prefixes[curve["way"]]
            same(numbers(curve["separation"]), file["ensemble/separation"])
            same(numbers(curve["mean"]), file[f"ensemble/{prefix}external_force_mean"])
            same(numbers(curve["std"]), file[f"ensemble/{prefix}external_force_std"])
            same(numbers(curve["integral"]), file[f"integral/{prefix}external_force"])
            same(numbers(curve["integral_std"]), file[f"integral/{prefix}external_force_std"])
            same(numbers(path_of_integral["force"]), file[f"integral/{prefix}external_force"])
        of = results["after_preload"][0] if name == "loop" else results["whole"]
        stuck, after = of["stuck"], "_after_preload" if name == "loop" else ""
        for end, key in (("", "p"), ("_low", "low"), ("_high", "high")):
            same(stuck[key], np.ravel(file[f"device/stuck_probability{end}{after}"])[0])
        if name == "loop":
            same([numbers(of["after"]) for of in pull_offs], file["replicas/pull_off_after_preload"])
            same(of["mean"], file["instability/pull_off_after_preload_mean"][0])
            same(of["interval"], file["instability/pull_off_after_preload_interval"][0])
            contacts = [of.decode() for of in file["model_range/plastic_contact"]]
            same([of["range"][one] for one in contacts], file["model_range/pull_off_after_preload"][:, 0])
            same([stuck["range"][one] for one in contacts], file["model_range/stuck_probability_after_preload"][:, 0])
    assert without_file(results["summary"]) == without_file(printed)
    assert shown(browser) == results["summary"]


def test_another_restoring_force_needs_no_new_replicas(opened, tmp_path):
    browser = opened(SMALL)
    browser.execute_script("lab.pullOffs.isKept = true")
    give(browser, "device-restoring_force", "20 nN")
    waited(browser, "lab.isComplete && lab.toml.includes('20 nN')")
    assert browser.execute_script("return lab.pullOffs.isKept") is True
    path = tmp_path / "pad.toml"
    path.write_text(SMALL.replace("100 nN", "20 nN"), encoding="utf-8")
    assert without_file(shown(browser)) == without_file(call(["run", str(path), "-o", str(tmp_path / "pad.h5")]))


@pytest.mark.slow
def test_times_are_reported(browser, address, capsys):
    """The first picture after the page is asked for, and the pad of the README with its 200 replicas."""
    browser.get("about:blank")
    browser.get(address)
    waited(browser, "globalThis.lab && lab.isComplete && lab.times.complete")
    times, seconds, workers = browser.execute_script("return [lab.times, lab.seconds, navigator.hardwareConcurrency]")
    with capsys.disabled():
        print(f"\n{workers} processors: first picture after {times['first picture']:.2f} s, 200 replicas after {times['replicas']:.1f} s, "
              f"with the model range {seconds:.1f} s")  # fmt: skip


# Fields, scene and link.


def shown(browser):
    return browser.execute_script("return document.getElementById('summary').textContent")


def text_of(browser, name):
    return browser.execute_script("return document.getElementById(arguments[0]).value", name)


def give(browser, name, text):
    """Types into a field and leaves it."""
    from selenium.webdriver.common.keys import Keys

    field = browser.find_element("id", name)
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys(text, Keys.TAB)


def scene_of(address):
    packed = address.split("#scene=")[1]
    return zlib.decompress(base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4)), -15).decode()


def test_fields_scene_and_link_are_in_step(opened):
    browser = opened(SMALL)
    assert text_of(browser, "toml") == SMALL and text_of(browser, "surface-surface_height_std") == "4 nm"
    give(browser, "surface-surface_height_std", "5.5 nm")
    changed = SMALL.replace('"4 nm"      ', '"5.5 nm"    ')
    given = waited(browser, "lab.isComplete && lab.toml.includes('5.5 nm') && lab.toml")
    assert text_of(browser, "toml") == given and stripped(given) == stripped(changed)
    assert scene_of(waited(browser, "lab.linked === lab.toml && location.href")) == given
    # A text that is typed changes the fields and the link.
    give(browser, "toml", given.replace("20 mJ/m^2", "30 mJ/m^2"))
    waited(browser, "lab.isComplete && lab.toml.includes('30 mJ/m^2')")
    assert text_of(browser, "material-work_of_adhesion") == "30 mJ/m^2"
    address = waited(browser, "lab.linked === lab.toml && location.href")
    assert scene_of(address) == text_of(browser, "toml")
    # The link alone opens the same scene.
    browser.get("about:blank")
    browser.get(address)
    waited(browser, "globalThis.lab && lab.isComplete")
    assert text_of(browser, "toml") == scene_of(address)


def stripped(scene):
    return [" ".join(line.split()) for line in scene.splitlines()]


def test_without_a_link_the_page_begins_with_the_pad_of_the_readme(opened):
    browser = opened(None, until="lab.integral")
    readme = (ROOT / "README.md").read_text(encoding="utf-8").split("```toml\n")[1].split("```")[0]
    assert browser.execute_script("return lab.toml").startswith(readme)
    assert browser.execute_script("return lab.about.replicas") == 200


def test_a_material_of_the_list_sets_its_numbers(opened):
    browser = opened(SMALL)
    assert browser.execute_script("return document.getElementById('material-of').selectedOptions[0].text") == "poly-Si"
    choose = "const e = document.getElementById(arguments[0]); e.value = [...e.options].find(o => o.text === arguments[1]).value; e.dispatchEvent(new Event('change'))"
    browser.execute_script(choose, "material-of", "SiO2")
    browser.execute_script(choose, "coating-of", "OTS")
    toml = waited(browser, "lab.toml.includes('44 mJ/m^2') && lab.toml")
    assert '"72 GPa"' in toml and '"9.25 GPa"' in toml and "= 0.17" in toml
    assert text_of(browser, "material-youngs_modulus") == "72 GPa"


def test_humid_air_comes_and_goes(opened):
    browser = opened(SMALL)
    browser.find_element("id", "humid").click()
    waited(browser, "lab.isComplete && lab.toml.includes('relative_humidity')")
    assert text_of(browser, "capillary-relative_humidity") == "0.45" and "bridges cover" in shown(browser)
    browser.find_element("id", "humid").click()
    assert "capillary" not in waited(browser, "lab.isComplete && !lab.toml.includes('humidity') && lab.toml")


def test_what_is_wrong_is_said_in_the_words_of_the_program_at_its_field(opened, tmp_path):
    browser = opened(SMALL)
    give(browser, "material-hardness", "12 GPA")
    waited(browser, "lab.problems.length > 0")
    said, invalid = browser.execute_script(
        "return [document.getElementById('material-hardness-problem').textContent, document.getElementById('material-hardness').getAttribute('aria-invalid')]"
    )
    path = tmp_path / "pad.toml"
    path.write_text(browser.execute_script("return lab.toml"), encoding="utf-8")
    with pytest.raises(stiction.SceneError) as refused:
        call(["check", str(path)])
    assert said in str(refused.value) and 'did you mean `GPa`?' in said and invalid == "true"
    assert "line 3" in browser.execute_script("return document.getElementById('problems').textContent")
    give(browser, "material-hardness", "12 GPa")
    waited(browser, "lab.isComplete && lab.problems.length === 0")
    assert browser.execute_script("return document.getElementById('material-hardness').hasAttribute('aria-invalid')") is False
    # A key that no scene has, typed into the scene.
    give(browser, "toml", SMALL.replace("hardness", "hardnes"))
    assert "did you mean `hardness`?" in waited(browser, "lab.problems.length > 0 && document.getElementById('problems').textContent")


DROP = """
const moved = new DataTransfer();
moved.items.add(new File([arguments[0]], "map.txt", { type: "text/plain" }));
document.getElementById("drop").dispatchEvent(new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer: moved }));
"""


def test_a_dropped_map_gives_its_summits(opened):
    path = ROOT / "configs" / "maps" / "polished.txt"
    browser = opened(SMALL)
    browser.execute_script(DROP, path.read_text(encoding="utf-8"))
    found = waited(browser, "lab.map")
    native = stiction.find_asperities(path)
    assert found["summits"] == native.asperities.radius.size
    for key, value in found["set"]:
        assert value in browser.execute_script("return lab.toml"), key
    browser.execute_script(DROP, "no map")
    assert waited(browser, "!document.getElementById('map-problem').hidden && document.getElementById('map-problem').textContent").startswith("map.txt: ")


# Who uses it, and how.


def test_nothing_is_asked_of_another_host(opened, address):
    browser = opened(SMALL)
    asked = browser.execute_script("return performance.getEntriesByType('resource').map(of => of.name)")
    assert len(asked) > 8 and all(name.startswith((address, "data:", "blob:")) for name in asked), asked
    policy = browser.execute_script("return document.querySelector('meta[http-equiv=Content-Security-Policy]').content")
    assert policy.startswith("default-src 'none'") and "http" not in policy and "*" not in policy
    for name in sorted(server.FOLDER.rglob("*")):
        if name.suffix in (".js", ".html", ".css") and "vendor" not in name.parts:
            assert "//" not in name.read_text(encoding="utf-8").replace("http://127", "").replace("// ", ""), name
    with lab.Server() as other:
        threading.Thread(target=other.serve_forever, daemon=True).start()
        reached = browser.execute_async_script("const done = arguments[1]; fetch(arguments[0]).then(() => done(true), () => done(false))", other.address)
        other.shutdown()
    assert reached is False
    assert any("Content Security Policy" in entry["message"] for entry in browser.get_log("browser"))


def test_every_control_has_a_name_and_every_figure_its_numbers(opened):
    browser = opened(SMALL)
    browser.execute_script("document.querySelectorAll('details').forEach(e => e.open = true)")
    nodes = browser.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    seen = [(node["role"]["value"], node.get("name", {}).get("value", "")) for node in nodes if not node["ignored"] and "role" in node]
    controls = [(role, name) for role, name in seen if role in ("button", "textbox", "slider", "combobox", "checkbox", "link", "DisclosureTriangle")]
    assert len([role for role, _ in controls if role == "slider"]) >= 11
    assert all(name.strip() for _, name in controls), controls
    figures = [name for role, name in seen if role in ("image", "img")]
    assert len(figures) == 3 and all(any(letter.isdigit() for letter in name) for name in figures), figures
    rows = browser.execute_script("return [...document.querySelectorAll('figure table')].map(e => e.rows.length)")
    assert all(count > 3 for count in rows), rows
    assert browser.execute_script("return document.getElementById('summary').getAttribute('role')") == "status"


def test_a_slider_is_moved_by_keys_and_focus_is_seen(opened):
    from selenium.webdriver.common.keys import Keys

    browser = opened(SMALL)
    browser.find_element("id", "material-work_of_adhesion").send_keys(Keys.TAB)
    focused = browser.switch_to.active_element
    assert focused.get_attribute("type") == "range"
    assert browser.execute_script("return getComputedStyle(document.activeElement).outlineStyle") == "solid"
    focused.send_keys(Keys.ARROW_RIGHT)
    waited(browser, "lab.isComplete && lab.toml.includes('20.9 mJ/m^2')")
    assert browser.switch_to.active_element.get_attribute("aria-valuetext") == "20.9 mJ/m^2"
    assert text_of(browser, "material-work_of_adhesion") == "20.9 mJ/m^2"


@pytest.mark.parametrize("width", [360, 390])
def test_the_page_fits_a_phone(opened, width):
    browser = opened(SMALL, width=width, height=844)
    browser.execute_script("document.querySelectorAll('details').forEach(e => e.open = true)")
    assert browser.execute_script("return [document.documentElement.scrollWidth, innerWidth]") == [width, width]
    plots = browser.execute_script("return [...document.querySelectorAll('.plot canvas')].map(e => e.getBoundingClientRect().width)")
    assert len(plots) == 3 and all(250 < of <= width for of in plots), plots


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_what_is_read_has_contrast_in_both_schemes(opened, scheme):
    browser = opened(SMALL)
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "screen", "features": [{"name": "prefers-color-scheme", "value": scheme}]})
    give(browser, "material-hardness", "12 GPA")
    waited(browser, "lab.problems.length > 0")
    papers = [browser.execute_script("return getComputedStyle(document.querySelector(arguments[0])).backgroundColor", of) for of in ("body", "#answer")]
    colors = browser.execute_script(
        "return [...document.querySelectorAll('p, small, label, legend, summary, pre, input[type=text], select, textarea, button, li, h1, h2, figcaption')].map(e => getComputedStyle(e).color)"
    )
    faint = {(color, paper) for color in colors for paper in papers if contrast(color, paper) < 4.5}
    assert len(colors) > 60 and not faint
    lines = [browser.execute_script("return getComputedStyle(document.querySelector(arguments[0])).color", f".swatch.{of}") for of in ("vermilion", "blue")]
    assert min(contrast(color, papers[0]) for color in lines) >= 3.0
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})


# The command.


def test_links_hold_scenes():
    assert scene_of(lab.link("http://127.0.0.1/", PAD)) == PAD


def test_the_command_says_how_to_build_what_is_missing(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(server, "CORE", tmp_path / "stiction.wasm")
    assert command.main(["--no-browser"]) == 2
    assert "scripts/lab.sh builds it" in capsys.readouterr().err
    with pytest.raises(FileError):
        lab.Server()
    assert command.main([str(tmp_path / "none.toml")]) == 2
    assert capsys.readouterr().err == f"stiction lab: {tmp_path / 'none.toml'}: No such file or directory\n"
    with pytest.raises(SystemExit):
        command.main(["--port", "70000"])
    assert "--port 70000: a whole number from 0 to 65535 is needed" in capsys.readouterr().err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_command_serves_the_page_until_it_is_interrupted(tmp_path, number):
    scene = tmp_path / "pad.toml"
    scene.write_text(SMALL, encoding="utf-8")
    # Whatever it is, the core is served.
    begin = f"""
import pathlib, sys
from stiction.lab import command, server
server.CORE = pathlib.Path({str(scene)!r})
sys.exit(command.main([{str(scene)!r}, "--no-browser"]))
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        [sys.executable, "-c", begin], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as process:  # fmt: skip
        address = process.stdout.readline().strip()
        assert scene_of(address) == SMALL
        page = address.split("#")[0]
        for name, kind in (("", "text/html"), ("lab.js", "text/javascript"), ("vendor/uplot/uPlot.esm.js", "text/javascript"), ("lab.css", "text/css")):
            with urllib.request.urlopen(page + name) as answer:
                assert answer.headers["Content-Type"].startswith(kind) and answer.read()
        for name in ("server.py", "vendor/", "../errors.py", "%2e%2e/errors.py"):
            with pytest.raises(urllib.error.HTTPError):
                urllib.request.urlopen(page + name)
        process.send_signal(number)
        assert process.wait(20) == 130
        assert process.stderr.read() == "stiction lab: interrupted\n"

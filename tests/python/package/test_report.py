"""A report says what the file has, needs no network, makes the result again, and is read in a real browser, in both colour schemes."""

import base64
import csv
import hashlib
import html
import io
import os
import re
import shutil
import subprocess

import h5py
import numpy as np
import pandas as pd
import pytest
import rare_patches

import stiction
import stiction.report
from stiction import FileError, plot, quantities
from stiction.program import find
from stiction.report.command import main
from stiction.report.facts import facts
from stiction.report.page import _data

KINDS = [
    "run", "retraction", "loop", "instability", "preload", "device", "pressed_sweep", "missed_preload", "stopping", "coupled", "background", "sweep", "grid_of_three", "choice", "comparison",
    "finite_size", "alone", "alone_sweep", "asperities", "partial",
]  # fmt: skip


def text_of(page):
    """The words of a page without its figures."""
    body = re.sub(r"<(style|svg)\b.*?</\1>", " ", page, flags=re.DOTALL)
    return " ".join(html.unescape(re.sub(r"<[^>]+>", " ", body)).split())


def slow_but(quick, names):
    """The names as cases, slow but for some."""
    return [pytest.param(name, marks=[pytest.mark.slow] * (name not in quick.split())) for name in names]


def test_a_page_tells_what_a_law_leaves_out(result):
    run = result("ending_law")
    assert ("left out by the law", run.left_out) in facts(run).computed
    assert f"left out by the law {run.left_out}" in text_of(stiction.report.page([run]))


@pytest.mark.parametrize("name", slow_but("run instability pressed_sweep coupled sweep comparison finite_size alone asperities partial", KINDS))
def test_every_kind_has_a_page_that_is_whole_and_needs_nothing_else(result, name):
    of = result(name)
    page = stiction.report.page([of])
    assert name != "run" or page == stiction.report.page([of])
    words = text_of(page)
    for heading in ("The number to quote", "Verdicts", "Figures", "What was computed", "How to make it again", "Provenance"):
        assert heading in words
    assert page.count("<figure ") == len(plot.panels(of)) == page.count("<svg ")
    assert hashlib.sha256(of.path.read_bytes()).hexdigest() in words
    assert all(warning in words for warning in map(lambda text: " ".join(text.split()), of.warnings))
    # Nothing is loaded from elsewhere, and no name is given twice.
    links = re.findall(r'(?:href|src)="([^"]*)"', page)
    assert links and all(link.startswith(("#", "data:")) for link in links)
    assert not re.findall(r"<(script|link|iframe|object)\b|url\((?!#)|@import", page)
    assert "unknown" not in words[words.rindex("Provenance"):]
    names = re.findall(r'\bid="([^"]*)"', page)
    assert len(names) == len(set(names))
    assert set(re.findall(r"url\(#([^)]*)\)", page)) | {link[1:] for link in links if link[0] == "#"} <= set(names)


def test_the_number_to_quote_is_that_of_the_file(result):
    run = result("run")
    words = text_of(stiction.report.page([run]))
    with h5py.File(run.path) as file:
        index = [name.decode() for name in file["ensemble/scalar"]].index("pull_off_force")
        mean, error, (low, high) = (
            file[f"ensemble/scalar_controlled_{of}"][index] for of in ("mean", "standard_error", "interval")
        )
    quoted, unit = re.search(r"pull-off force ([\d.]+ ± [\d.]+) (.N)", words).groups()
    scale = {"n": 1e-9, "µ": 1e-6, "m": 1e-3}[unit[0]]
    assert [float(part) * scale for part in quoted.split(" ± ")] == pytest.approx([mean, error], rel=0.05)
    assert float(quoted.split(" ± ")[0]) * scale == pytest.approx(mean, abs=0.051 * error)
    interval = re.search(r"95 % interval ([\d.]+) (.)N to ([\d.]+) (.)N", words).groups()
    scales = {"n": 1e-9, "µ": 1e-6, "m": 1e-3}
    assert float(interval[0]) * scales[interval[1]] == pytest.approx(low, rel=1e-3)
    assert float(interval[2]) * scales[interval[3]] == pytest.approx(high, rel=1e-3)


def test_probabilities_of_a_device_are_of_every_preload(result):
    """The tables of a sweep have a row for each point and preload, with the values of its key; a missed preload has dashes."""
    sweep = result("yielding_sweep")
    found = facts(sweep)
    pull_offs, chances = (table for table in found.tables if table.caption.startswith(("Points", "Probability that the pull-off is above 2.000 µN")))
    device, after = sweep.group("device"), sweep.group("instability")
    ranges = sweep.group("model_range")["stuck_probability_after_preload"]
    expected, means = [], []
    for point, energy in enumerate(("20.00 mJ/m²", "50.00 mJ/m²")):
        for place, load in ((0, "1.00 mN"), (1, "10.0 N")):
            share, low, high = (float(device[f"stuck_probability{end}_after_preload"][point, place]) for end in ("", "_low", "_high"))
            mean = float(after["pull_off_after_preload_mean"][point, place])
            means.append([energy, load, "–" if np.isnan(mean) else quantities.si(mean, "N", 3).split(" ")[1]])
            if np.isnan(mean):
                expected.append([energy, load, "–", "–", "–"])
                continue
            numbers = [quantities.number(100.0 * float(of(ranges[point].isel(preload=place))), 3) for of in (np.min, np.max)]
            of = f"{numbers[0]} %" if numbers[0] == numbers[1] else f"{numbers[0]} to {numbers[1]} %"
            interval = f"{quantities.number(100.0 * low, 3)} to {quantities.number(100.0 * high, 3)} %"
            expected.append([energy, load, f"{quantities.number(100.0 * share, 3)} %", interval, of])
    assert chances.header[1:] == ["preload", "probability", "95 % interval", "model range"] and chances.rows == expected
    assert [[*row[:2], row[2].split(" ")[-1]] for row in pull_offs.rows] == means
    labels = [number.label for number in found.numbers]
    assert "P(pull-off > 2.000 µN) after 1.00 mN" in labels
    of_run = {number.label: number for number in facts(result("device")).numbers}
    run = result("device").after_preload("100 mN")
    number = of_run["P(pull-off > 600.0 µN) after 100 mN"]
    assert number.value == float(run["stuck_probability"]) and number.note.startswith("95 % interval ") and "model range" in number.note


def test_equal_patches_have_their_bound_in_place_of_an_error():
    """One soft asperity pulls 2πRΔγ in every patch: of 74 or more that agree at most 1 − 0.05^(1/n) differ, less than two errors of 2 %."""
    tables = rare_patches.Scene("dmt", 1, 1.0).tables()
    tables["separation"] = {"h": {"from": "-9 nm", "to": "9 nm", "count": 73}}
    tables["ensemble"] = {"max_replicas": 1000, "target": [{"quantity": "pull_off_force", "relative_standard_error": 0.02}]}
    with stiction.run(tables, progress=False) as run:
        of = facts(run)
        replicas = run.pull_off.replicas
        assert run.pull_off.mean_over_patches == pytest.approx(rare_patches.ONE, rel=1e-6) and 74 <= replicas < 1000
    bound = f"all {replicas} replicas agree: with 95 % confidence at most {quantities.number(100 * (1 - 0.05 ** (1 / replicas)))} % of patches differ"
    targets = next(table for table in of.tables if table.caption == "Targets")
    assert targets.rows[0][1] == bound and targets.rows[0][3] == "met"
    assert [number.note for number in of.numbers if number.label == "pull-off force"] == [bound]


def test_the_data_behind_a_figure_are_the_datasets(result):
    run = result("run")
    page = stiction.report.page([run])
    links = dict(re.findall(r'<a download="([^"]*)" href="data:text/csv;charset=utf-8;base64,([^"]*)"', page))
    assert list(links) == [f"run_{name}.csv" for name in plot.panels(run)]
    rows = list(csv.DictReader(io.StringIO(base64.b64decode(links["run_force.csv"]).decode())))
    for column, path in (
        ("h_star", "ensemble/h_star"),
        ("separation (m)", "ensemble/separation"),
        ("ensemble external_force_mean (N)", "ensemble/external_force_mean"),
        ("integral external_force (N)", "integral/external_force"),
    ):
        np.testing.assert_array_equal([float(row[column]) for row in rows], run[path].values)
    quantile = [float(row["ensemble external_force_quantile quantile 0.95 (N)"]) for row in rows]
    np.testing.assert_array_equal(quantile, run["ensemble/external_force_quantile"].sel(quantile=0.95).values)
    patches = list(csv.DictReader(io.StringIO(base64.b64decode(links["run_pull_off.csv"]).decode())))
    np.testing.assert_array_equal([float(row["pull_off_force (N)"]) for row in patches], run["replicas/pull_off_force"].values)


def test_texts_of_a_csv_are_no_formulas():
    given = {"=1+1": ["=cmd|' /C calc'!A0", "@sum(a)", "+a", "-a", " =1", "a=1"], "x": [-1.0, 2.0, 3.0, 4.0, 5.0, 6.0]}
    given["text"] = ["-1.5", "+2", "-inf", "a", "", "1e-9"]
    link = re.search(r'base64,([^"]*)"', _data(pd.DataFrame(given), "a.csv"))[1]
    rows = list(csv.reader(io.StringIO(base64.b64decode(link).decode())))
    assert rows[0] == ["'=1+1", "x", "text"]
    assert [row[0] for row in rows[1:]] == [f"'{text}" for text in given["=1+1"][:5]] + ["a=1"]
    assert [float(row[1]) for row in rows[1:]] == given["x"] and [row[2] for row in rows[1:]] == given["text"]


def test_the_share_of_the_mean_planes_is_reported(result):
    run = result("background")
    [number] = [number for number in facts(run).numbers if number.label == "attraction of the mean planes"]
    place, h = float(run["integral"].attrs["pull_off_separation"]), run["background/separation"].values
    at = np.interp(place, h, run["background/force"].values)
    np.testing.assert_allclose(number.value, at)
    share = at / (at + np.interp(place, h, run["integral/adhesion_force"].values))
    assert f"{100 * share:.3g} %" in number.note and "electrostatic 1.8" in number.note


def test_verdicts_have_a_word_a_sign_and_a_grade(result):
    page = stiction.report.page([result("run")])
    found = re.findall(r'<li data-verdict="([^"]*)"><span class="sign (\w+)" aria-hidden=true>(.)</span><span>[^<]*<b class=(\w+)>([^<]*)', page)
    assert [of[0] for of in found] == ["cross-check", "validity", "independence", "resolution"]
    for _, grade, sign, again, word in found:
        assert {"good": "✓", "caution": "!", "bad": "✗", "none": "–"}[grade] == sign and grade == again and word


def changed(result, name, tmp_path, path, **attributes):
    """A copy of a result with other attributes or values."""
    copy = result(name).save(tmp_path / "changed.h5", force=True)
    with h5py.File(copy, "r+") as file:
        for attribute, value in attributes.items():
            if isinstance(value, str):
                file[path].attrs[attribute] = value
            else:
                file[f"{path}/{attribute}"][...] = value
    return stiction.open_run(copy)


@pytest.mark.parametrize(
    "path, attributes, subject, grade, word",
    [
        ("validation", {"verdict": "disagree"}, "cross-check", "bad", "disagree"),
        ("validation", {"verdict": "not tested"}, "cross-check", "none", "not tested"),
        ("independence", {"verdict": "invalid"}, "independence", "bad", "invalid"),
        ("independence", {"verdict": "a shift"}, "independence", "caution", "a shift"),
        ("/", {"warnings": "lambda = 9 is above 5"}, "validity", "caution", "1 warning"),
        ("/", {"warnings": "the separations are too coarse: by far"}, "resolution", "caution", "look"),
    ],
)
def test_verdicts_follow_the_file(result, tmp_path, path, attributes, subject, grade, word):
    of = changed(result, "run", tmp_path, path, **attributes)
    verdict = next(verdict for verdict in facts(of).verdicts if verdict.subject == subject)
    assert (verdict.grade, verdict.word) == (grade, word)


def test_a_pull_off_at_the_edge_is_reported(tmp_path):
    scene = os.path.join(os.path.dirname(__file__), "..", "..", "..", "configs", "case_ii.toml")
    cut = stiction.run(scene, tmp_path / "cut.h5", replicas=8, **{"separation.h_star": {"from": 3.5, "to": 8.0, "count": 46}})
    verdict = facts(cut).verdicts[-1]
    assert (verdict.subject, verdict.grade, verdict.word) == ("resolution", "bad", "at the edge")


def test_one_patch_has_no_error_and_no_interval(tmp_path):
    scene = os.path.join(os.path.dirname(__file__), "..", "..", "..", "configs", "quick.toml")
    words = text_of(stiction.report.page([stiction.run(scene, tmp_path / "one.h5", replicas=1)]))
    assert "of one patch: it has no standard error" in words and "1 patch, independent" in words
    assert "interval" not in words.split("Verdicts")[0] and "nan" not in words.lower().split()


def test_what_a_scene_says_is_not_taken_for_html(result, tmp_path):
    evil = "</title></pre><script>alert('x')</script>&amp;"
    of = changed(result, "run", tmp_path, "/", title=evil, scene=f"# {evil}\n{result('run').scene_text}", warnings=evil)
    page = stiction.report.page([of])
    assert "<script" not in page
    assert text_of(page).count("<script>alert('x')</script>&amp;") == 6


def commands_of(page):
    found = re.findall(r"<summary>Command with scene, to paste</summary><pre>(.*?)</pre>", page, flags=re.DOTALL)
    found += re.findall(r"<pre>(stiction asperities .*?)</pre>", page, flags=re.DOTALL)
    return [html.unescape(command) for command in found]


@pytest.mark.parametrize("name", slow_but("run sweep comparison asperities", [
    "run", "retraction", "coupled", "stopping", "sweep", "comparison", "finite_size", "alone", "asperities",
]))  # fmt: skip
def test_the_command_of_a_page_makes_the_same_numbers(result, name, tmp_path):
    of = result(name)
    (command,) = commands_of(stiction.report.page([of]))
    if name == "asperities":
        shutil.copy(os.path.join(os.path.dirname(__file__), "..", "..", "..", "configs", "maps", "polished.txt"), tmp_path)
    program = os.path.dirname(shutil.which(find()) or find())
    environment = os.environ | {"PATH": f"{program}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(["sh", "-e"], input=command, cwd=tmp_path, env=environment, text=True, capture_output=True, timeout=120)
    assert done.returncode == 0, done.stderr
    with h5py.File(of.path) as first, h5py.File(tmp_path / of.path.name) as second:
        paths = []
        first.visititems(lambda path, node: paths.append(path) if isinstance(node, h5py.Dataset) else None)
        for path in paths:
            if not path.startswith("diagnostics/"):
                np.testing.assert_array_equal(first[path][()], second[path][()], err_msg=path)


def test_several_results_are_side_by_side_with_differences(result):
    first, second = result("run"), result("retraction")
    page = stiction.report.page([first, second])
    words = text_of(page)
    assert words.startswith("2 results side by side")
    ratio = second.pull_off.mean_over_patches / first.pull_off.mean_over_patches
    reported = re.search(r"pull-off force [^…]* … against the first ([+−][\d.]+) ± ([\d.]+) %", words).groups()
    assert float(reported[0].replace("−", "-")) == pytest.approx(100 * (ratio - 1), rel=0.01)
    error = np.hypot(second.pull_off.standard_error / first.pull_off.mean_over_patches, ratio * first.pull_off.standard_error / first.pull_off.mean_over_patches)
    assert float(reported[1]) == pytest.approx(100 * error, rel=0.06)
    assert page.count('<h3>run.h5</h3>') == page.count("<h3>retraction.h5</h3>") >= 6


def test_a_partial_result_says_so(result):
    of = result("partial")
    assert f"PARTIAL: {of.attrs['replicas']} of 64 replicas" in text_of(stiction.report.page([of]))
    assert "PARTIAL" not in text_of(stiction.report.page([result("run")]))


def test_laws_that_do_not_pull_have_no_pull_off(result):
    of = facts(result("comparison"))
    rows = {row[0]: row for row in of.tables[0].rows}
    force = result("comparison").integral["pull_off_force"]
    assert list(rows) == list(force["model_law"].values) and rows["gw"][1:3] == ["none", "none"]
    assert rows["emd"][2] == quantities.si(force.sel(model_law="emd"), "N")
    assert ("model.law", ", ".join(rows)) in of.computed
    assert [verdict.word for verdict in of.verdicts if verdict.subject == "resolution"] == ["fine"]


def test_the_command_writes_a_page_and_overwrites_none(result, tmp_path, capsys):
    copy = result("run").save(tmp_path / "a.h5")
    assert main([str(copy)]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'a.html'}\n"
    written = (tmp_path / "a.html").read_bytes()
    (tmp_path / "a.html").write_text("mine")
    assert main([str(copy)]) == 2
    assert capsys.readouterr().err == f"stiction report: {tmp_path / 'a.html'}: exists; --force overwrites it\n"
    assert (tmp_path / "a.html").read_text() == "mine"
    assert main([str(copy), "--force"]) == 0
    assert (tmp_path / "a.html").read_bytes() == written
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.h5", "a.html"]
    with pytest.raises(FileError, match="exists; force=True"):
        stiction.report.write([copy], tmp_path / "a.html")
    with pytest.raises(FileError, match="a report needs a result"):
        stiction.report.write([], tmp_path / "b.html")


def test_what_is_wrong_is_reported_in_one_line(result, tmp_path, capsys):
    assert main([str(tmp_path / "none.h5")]) == 2
    assert capsys.readouterr().err == f"stiction report: {tmp_path / 'none.h5'}: no such file\n"
    assert main([str(result("run").path), "-o", str(tmp_path / "none" / "a.html")]) == 2
    assert "there is no folder" in capsys.readouterr().err
    with pytest.raises(SystemExit) as ended:
        main([str(result("run").path), "-o", "a.pdf"])
    assert ended.value.code == 2 and "--output a.pdf: a name that ends with .html is needed" in capsys.readouterr().err


def shown(browser, page, width=1200, height=900, scheme="light", media="screen"):
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
    )
    browser.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"media": media, "features": [{"name": "prefers-color-scheme", "value": scheme}]}
    )
    browser.get(page.as_uri())


def luminance(color):
    red, green, blue = (int(part) / 255 for part in re.findall(r"\d+", color)[:3])
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in (red, green, blue)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_page_is_seen_in_both_schemes(result, browser, tmp_path, scheme):
    page = stiction.report.write([result("instability")], tmp_path / "page.html")
    shown(browser, page, scheme=scheme)
    ask = browser.execute_script
    assert ask("return document.title") == result("instability").title
    value = ask("const e = document.querySelector('.number .value'); return [e.innerText, e.getBoundingClientRect().top]")
    assert value[0] == str(result("instability").pull_off) and 0 < value[1] < 900
    paper = ask("return getComputedStyle(document.body).backgroundColor")
    assert (luminance(paper) > 0.8) == (scheme == "light")
    # All that is read has the contrast of WCAG 2 AA, also the text of figures.
    for selector in ("p", "td", "th", "small", "b.good, b.caution, b.bad", "summary", "figure svg text"):
        colors = ask(
            "return [...document.querySelectorAll(arguments[0])].map(e => {const s = getComputedStyle(e);"
            " return e instanceof SVGElement ? s.fill : s.color})", selector,
        )  # fmt: skip
        assert colors, selector
        assert min(contrast(color, paper) for color in colors) >= 4.5, (selector, scheme)
    # Curves are reported from the paper.
    strokes = ask(
        "return [...document.querySelectorAll('figure svg path')].map(e => getComputedStyle(e))"
        ".filter(s => parseFloat(s.strokeWidth) >= 1.2 && s.stroke !== 'none').map(s => s.stroke)"
    )
    assert strokes and min(contrast(color, paper) for color in strokes if color.startswith("rgb")) > 1.9
    assert [entry for entry in browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")] == []


def test_data_are_behind_a_click_and_can_be_taken_away(result, browser, tmp_path):
    page = stiction.report.write([result("run")], tmp_path / "page.html")
    shown(browser, page)
    ask = browser.execute_script
    assert ask("return document.querySelector('figure table').checkVisibility()") is False
    browser.find_element("css selector", "figure summary").click()
    assert ask("return document.querySelector('figure table').checkVisibility()") is True
    assert ask("return document.querySelectorAll('figure table')[0].rows.length") == 1 + result("run")["ensemble/h_star"].size
    link = browser.find_element("css selector", "figure a[download]")
    assert link.is_displayed() and link.get_attribute("download") == "run_force.csv"


@pytest.mark.parametrize("name", ["run", "instability", "sweep", "comparison", "asperities"])
def test_a_page_fits_a_phone(result, browser, tmp_path, name):
    page = stiction.report.write([result(name), result("run")], tmp_path / "page.html")
    shown(browser, page, width=360, height=740)
    widths = browser.execute_script("return [document.documentElement.scrollWidth, window.innerWidth]")
    assert widths[0] <= widths[1] == 360
    sizes = browser.execute_script(
        "return [...document.querySelectorAll('figure svg')].map(e => {const b = e.getBoundingClientRect(); return [b.width, b.height]})"
    )
    assert sizes and all(250 < width <= 360 and height > 100 for width, height in sizes)


def test_files_are_side_by_side_on_a_wide_screen_and_below_each_other_on_a_phone(result, browser, tmp_path):
    page = stiction.report.write([result("run"), result("retraction")], tmp_path / "page.html")
    place = "return [...document.querySelectorAll('.number')].map(e => {const b = e.getBoundingClientRect(); return [b.left, b.top]})"
    shown(browser, page)
    (left, top), (right, same) = browser.execute_script(place)
    assert right > left + 300 and top == same
    shown(browser, page, width=360, height=740)
    (left, top), (below, lower) = browser.execute_script(place)
    assert left == below and lower > top


def test_a_page_is_printed_dark_on_white_without_its_data(result, browser, tmp_path):
    page = stiction.report.write([result("run")], tmp_path / "page.html")
    shown(browser, page, scheme="dark", media="print")
    ask = browser.execute_script
    assert luminance(ask("return getComputedStyle(document.documentElement).getPropertyValue('--paper').trim() === '#ffffff' ? 'rgb(255,255,255)' : 'rgb(0,0,0)'")) == 1.0
    assert ask("return document.querySelector('.data-of-figure').checkVisibility()") is False
    printed = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", {"printBackground": False})["data"])
    assert printed.startswith(b"%PDF") and 2 <= len(re.findall(rb"/Type\s*/Page\b", printed)) <= 6

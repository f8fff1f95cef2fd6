"""A program that depends on the crate by a path, on a machine without CMake: the line that docs/library.md gives finds or makes one."""

import re
import shutil
import subprocess

import pytest
from program import ROOT


# In the place of libhdf5's, which takes minutes: a build script runs what CMAKE names in a folder of its own, as that one does.
BUILD = """
fn main() {
    let cmake = std::env::var_os("CMAKE").expect("CMAKE is set");
    let folder = std::env::var_os("OUT_DIR").unwrap();
    let output = std::process::Command::new(cmake).arg("--version").current_dir(folder).output().expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    std::fs::write("said", output.stdout).unwrap();
}
"""


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("cargo"), reason="no cargo")
def test_the_line_of_the_page_gives_a_cmake(tmp_path, monkeypatch):
    line = re.search(r"^env\.CMAKE = .*$", (ROOT / "docs/library.md").read_text(), re.M)[0]
    assert "../stiction/" in line
    user = tmp_path / "user"
    (user / "src").mkdir(parents=True)
    (user / ".cargo").mkdir()
    (tmp_path / "stiction").symlink_to(ROOT)
    (user / ".cargo" / "config.toml").write_text(line + "\n")
    (user / "Cargo.toml").write_text('[package]\nname = "user"\nversion = "0.1.0"\nedition = "2024"\n')
    (user / "build.rs").write_text(BUILD)
    (user / "src" / "main.rs").write_text("fn main() {}\n")
    for name in ("CMAKE", "CARGO_TARGET_DIR", "CARGO_BUILD_TARGET_DIR"):
        monkeypatch.delenv(name, raising=False)
    # `check` runs build scripts too. From another folder, as an editor would.
    subprocess.run(["cargo", "check", "--quiet", "--offline"], cwd=user / "src", check=True, timeout=600)
    version = re.search(r"cmake version (\d+)\.(\d+)", (user / "said").read_text())
    assert (int(version[1]), int(version[2])) >= (3, 26)

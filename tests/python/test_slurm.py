"""scripts/slurm without Slurm: sbatch, squeue, scancel and scontrol that write down what they are asked, and a program that counts.

What they do on a cluster is tested by scripts/slurm/test_cluster.sh.
"""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from program import PROGRAM, ROOT
from same_bits import contents

SCRIPTS = ROOT / "scripts" / "slurm"

pytestmark = pytest.mark.skipif(os.name != "posix", reason="scripts for bash")

# Each writes its arguments, one to a line, and a line with an end of record, into calls/NAME. sbatch numbers its jobs from 100.
RECORD = "printf '%s\\n' \"$@\" $'\\x1e' >>"
SBATCH = """
count=$(grep -c $'^\\x1e$' calls/sbatch)
[[ ! -e fakes/refuse-$count ]] || { echo "sbatch: error: Invalid account" >&2; exit 1; }
echo $((99 + count))
"""
SQUEUE = '[[ ! -e fakes/mute ]] && cat fakes/queue 2>/dev/null || [[ ! -e fakes/mute ]]'
SCONTROL = '[[ $1 != show ]] || echo "MaxArraySize            = 101"'

# Counts to 40 replicas, 50 in a second, and keeps the count; a TERM saves it. `fakes/behaviour` is sourced before.
STICTION = """
here=$(dirname "$0")
RECORD"$here/calls/stiction"
case $1 in
info) echo "  replicas there   $(wc -c <"$2") of 40 are done"; exit 0 ;;
run)
    [[ $2 != --help ]] || { echo "--shard I/N"; exit 0; }
    ! grep -q bad "$2" || { echo "stiction: bad scene" >&2; exit 2; }
    [[ $4 != 1/1000000 ]] || exit 0
    ;;
*) exit 0 ;;
esac
while (($#)); do [[ $1 != -o ]] || output=$2; shift; done
[[ ! -e $output ]] || exit 0
count=0
[[ ! -e $output.partial ]] || count=$(wc -c <"$output.partial")
ends=''
trap 'ends=1; echo term >>"$here/calls/signals"' TERM
[[ ! -e $here/fakes/behaviour ]] || . "$here/fakes/behaviour"
while ((count < 40)); do
    sleep 0.02
    ((++count))
    printf x >>"$output.partial"
    [[ ! $ends ]] || exit 130
done
mv "$output.partial" "$output"
""".replace("RECORD", RECORD)


class Site:
    """A folder with a scene, and with a Slurm and a program that are none."""

    def __init__(self, folder: Path):
        self.folder = folder / "my work"
        for name in ("bin", "calls", "fakes"):
            (self.folder / name).mkdir(parents=True)
        for name, text in {"sbatch": SBATCH, "squeue": SQUEUE, "scancel": "", "scontrol": SCONTROL}.items():
            record = f"cd '{self.folder}'\n{RECORD}calls/{name}\n"
            self.script(f"bin/{name}", record + text)
        self.script("stiction", STICTION)
        (self.folder / "case two.toml").write_text("format = 1\n")
        self.environment = {**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}"}
        self.tasks: list[Task] = []

    def script(self, name: str, text: str) -> None:
        path = self.folder / name
        path.write_text("#!/usr/bin/env bash\n" + text)
        path.chmod(0o755)

    def submit(self, *arguments: str, own: bool = True) -> subprocess.CompletedProcess:
        own_arguments = ["case two.toml", "--stiction", "./stiction"] if own else []
        command = [SCRIPTS / "submit.sh", *own_arguments, *arguments]
        return subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=30)

    def calls(self, name: str) -> list[list[str]]:
        path = self.folder / "calls" / name
        text = path.read_text() if path.exists() else ""
        return [call.split("\n")[:-1] for call in text.split("\x1e\n")[:-1]]

    def signals(self) -> int:
        """How many the program has got."""
        path = self.folder / "calls" / "signals"
        return len(path.read_text().splitlines()) if path.exists() else 0

    def files(self) -> list[str]:
        ours = ("bin", "calls", "fakes", "stiction")
        found = [path.relative_to(self.folder) for path in self.folder.rglob("*") if path.is_file()]
        return sorted(str(path) for path in found if path.parts[0] not in ours)

    def complete(self, *shards: int) -> None:
        for shard in shards:
            (self.folder / "case two" / "shards" / f"{shard}.shard").write_text("")

    def queue(self, text: str) -> None:
        (self.folder / "fakes" / "queue").write_text(text)


@pytest.fixture
def site(tmp_path):
    site = Site(tmp_path)
    yield site
    # Of a test that failed, a task may still wait for something.
    for task in site.tasks:
        if task.process.poll() is None:
            task.end()


def test_an_array_and_a_merge_are_submitted(site):
    said = site.submit("--shards", "12", "--seed=7", "--replicas", "800", "--at-once", "5", "--time=30", "-c", "4")
    assert said.returncode == 0, said.stderr
    array, merge = site.calls("sbatch")
    output = f"{site.folder}/case two"
    assert array == [
        "--parsable", "--job-name=stiction-case two", "--nodes=1", "--ntasks=1", "--requeue", "--time=30", "-c", "4",
        "--array=1-12%5", "--signal=B:USR1@120", "--open-mode=append", f"--chdir={output}", "--output=logs/shard-%2a.log",
        f"{SCRIPTS}/shard.sh", output, f"{site.folder}/stiction", f"{site.folder}/case two.toml", "12", "120", "300", "",
        "--seed", "7", "--replicas", "800",
    ]  # fmt: skip
    assert merge == [
        "--parsable", "--job-name=stiction-case two-merge", "--nodes=1", "--ntasks=1", "--requeue", "--time=30",
        "--dependency=afterok:100", "--kill-on-invalid-dep=yes", "--open-mode=append", f"--chdir={output}", "--output=logs/merge.log",
        f"{SCRIPTS}/merge.sh", output, f"{site.folder}/stiction", f"{output}/case two.h5", "12",
    ]  # fmt: skip
    assert "12 submitted as job 100" in said.stdout and "job 101, after them" in said.stdout
    assert "squeue --jobs=100,101" in said.stdout
    # The command that it prints is the same command.
    site.queue("")
    again = next(line.removeprefix("restart").strip() for line in said.stdout.splitlines() if line.startswith("restart"))
    repeated = subprocess.run(["bash", "-c", again], cwd="/", env=site.environment, capture_output=True, text=True)
    assert repeated.returncode == 0 and "as job 102" in repeated.stdout, repeated.stderr
    assert site.calls("sbatch")[2] == array


def test_the_merge_gets_who_and_where_of_the_array(site):
    options = ["-A", "mine", "--partition=big", "-qlong", "--mem-per-cpu", "2G", "--cpus-per-task=8", "--gres", "gpu:1", "-t1:00", "--mail-type=END"]
    assert site.submit("--shards=3", *options).returncode == 0
    array, merge = site.calls("sbatch")
    assert [argument for argument in array if argument in options] == options
    shared = ["-A", "mine", "--partition=big", "-qlong", "--mem-per-cpu", "2G", "-t1:00", "--mail-type=END"]
    assert merge[5 : 5 + len(shared)] == shared and not set(merge) & {"--cpus-per-task=8", "--gres", "gpu:1"}


def test_the_merge_has_its_own_time_and_memory(site):
    assert site.submit("--shards=3", "--time", "10:00", "--mem=1G", "--merge-time=5", "--merge-mem", "32G").returncode == 0
    array, merge = site.calls("sbatch")
    assert {"--time", "10:00", "--mem=1G"} <= set(array)
    assert {"--time=5", "--mem=32G"} <= set(merge) and not {"--time", "10:00", "--mem=1G"} & set(merge)


@pytest.mark.parametrize(
    "arguments, message",
    [
        ((), "no --shards"),
        (("--shards",), "--shards has no value"),
        (("--shards", "0"), "--shards 0: a whole number from 1, such as 16"),
        (("--shards", "1e3"), "--shards 1e3: a whole number from 1"),
        (("--shards", "101"), "--shards 101: at most 100 on this cluster (its MaxArraySize is 101)"),
        (("--shards", "4", "--seed", "-1"), "--seed -1: a whole number from 0"),
        (("--shards", "4", "--replicas=0"), "--replicas 0: a whole number from 1"),
        (("--shards", "4", "--at-once", "x"), "--at-once x: a whole number from 1"),
        (("--shards", "4", "--checkpoint", "1m"), "--checkpoint 1m: seconds"),
        (("--shards", "4", "--save-before", "70000"), "--save-before 70000: seconds, from 1 to 65535"),
        (("--shards", "4", "--copy-every", "0"), "--copy-every 0: seconds"),
        (("--shards", "4", "--scratch", "local"), "--scratch local: a folder of the nodes that begins with /"),
        (("--shards", "4", "--array=1-3"), "--array=1-3 is set by submit.sh"),
        (("--shards", "4", "-D/tmp"), "-D/tmp is set by submit.sh"),
        (("--shards", "4", "--signal", "TERM@60"), "--signal is set by submit.sh; give --save-before"),
        (("--shards", "4", "--dependency=afterok:1"), "--dependency=afterok:1"),
        (("--shards", "4", "--wait"), "--wait: the merge is submitted along"),
        (("--shards", "4", "-M", "other"), "SLURM_CLUSTERS"),
        (("--shards", "4", "other.toml"), "other.toml is neither an option nor the value of one"),
        (("--shards", "4", "--time=1", "2"), "2 is neither an option nor the value of one"),
        (("--shards", "4", "--stiction", "nowhere"), "--stiction nowhere: no such program"),
        (("--shards", "4", "--stiction", "bin/scancel"), "bin/scancel: not a stiction that knows run --shard"),
        (("--shards", "4", "--output", "stiction"), "stiction: not a folder"),
        (("--shards", "4", "--output", "bin"), "bin: a folder that is neither empty nor an experiment"),
    ],
)
def test_bad_arguments_are_refused(site, arguments, message):
    before = site.files()
    refused = site.submit(*arguments)
    assert refused.returncode == 2 and message in refused.stderr, refused
    assert refused.stderr.startswith("submit.sh: ") and refused.stderr.count("\n") == 1
    assert site.files() == before and not site.calls("sbatch")


@pytest.mark.parametrize(
    "arguments, message",
    [
        ((), "no scene"),
        (("--shards", "4"), "the scene comes first"),
        (("nowhere.toml", "--shards", "4", "--stiction=./stiction"), "nowhere.toml: no such scene"),
        (("bad.toml", "--shards", "4", "--stiction=./stiction"), "bad scene"),
    ],
)
def test_bad_scenes_are_refused(site, arguments, message):
    (site.folder / "bad.toml").write_text("bad")
    refused = site.submit(*arguments, own=False)
    assert refused.returncode == 2 and message in refused.stderr and refused.stderr.count("\n") == 1, refused
    assert not site.calls("sbatch") and not (site.folder / "bad").exists()


def test_a_machine_without_slurm_is_reported(site):
    # Everything but Slurm.
    tools = site.folder / "tools"
    tools.mkdir()
    for name in ("bash", "basename", "cat", "cksum", "dirname", "id", "ls", "mkdir", "realpath", "sed"):
        (tools / name).symlink_to(shutil.which(name))
    site.environment["PATH"] = str(tools)
    refused = site.submit("--shards", "4")
    assert refused.returncode == 2 and "no sbatch on the PATH" in refused.stderr, refused


def test_nothing_that_is_printed_steers_the_terminal(site):
    (site.folder / "a\x1b[31m.toml").write_text("format = 1\n")
    refused = site.submit("a\x1b[31m.toml", "--shards", "x\x1b]0;title\x07", "--stiction", "./stiction", own=False)
    assert refused.returncode == 2 and "--shards x?]0;title?: a whole number" in refused.stderr
    said = site.submit("a\x1b[31m.toml", "--shards", "3", "--stiction", "./stiction", own=False)
    assert said.returncode == 0 and "a?[31m/logs" in said.stdout
    again = site.submit("a\x1b[31m.toml", "--shards", "4", "--stiction", "./stiction", own=False)
    assert again.returncode == 2
    for text in (refused.stderr, said.stdout, again.stderr):
        assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f]", text), repr(text)


def test_help_names_every_option(site):
    said = site.submit("--help", own=False)
    assert said.returncode == 0
    for option in ("shards", "output", "stiction", "seed", "replicas", "checkpoint", "at-once", "save-before", "scratch", "copy-every", "merge-time"):
        assert f"--{option}" in said.stdout, option


def test_what_is_complete_or_in_the_queue_is_not_submitted_again(site):
    assert site.submit("--shards", "9").returncode == 0
    site.complete(2, 3)
    # Task 7 comes to its end without a file, 5 and 8 go on, 9 is of another user's experiment.
    site.queue("100 5 RUNNING\n100 8 PENDING\n100 7 COMPLETING\n55 9 RUNNING\n101 N/A PENDING\n")
    said = site.submit("--shards", "9", "--time=10")
    assert said.returncode == 0, said.stderr
    assert "9, of which 2 complete, 2 in the queue before, 5 submitted as job 102" in said.stdout
    array, merge = site.calls("sbatch")[2:]
    assert "--array=1,4,6-7,9" in array
    # What failed of the first array is in the second.
    assert "--dependency=afterok:102,afterany:100" in merge
    assert site.calls("scancel") == [["101"]]


def test_a_complete_experiment_is_merged_only(site):
    assert site.submit("--shards", "3").returncode == 0
    site.complete(1, 2, 3)
    said = site.submit("--shards", "3")
    assert said.returncode == 0 and "3, of which 3 complete, 0 in the queue before, 0 submitted\n" in said.stdout, said
    (merge,) = site.calls("sbatch")[2:]
    assert f"{SCRIPTS}/merge.sh" in merge
    assert not [argument for argument in merge if argument.startswith("--dependency")]


def test_an_experiment_in_the_queue_is_left_there(site):
    assert site.submit("--shards", "3").returncode == 0
    site.queue("100 1 RUNNING\n100 2 RUNNING\n100 3 PENDING\n101 N/A PENDING\n")
    said = site.submit("--shards", "3")
    assert said.returncode == 0 and "nothing submitted" in said.stdout and "squeue --jobs=100,101" in said.stdout
    assert len(site.calls("sbatch")) == 2 and not site.calls("scancel")
    site.queue("101 N/A RUNNING\n")
    refused = site.submit("--shards", "3")
    assert refused.returncode == 2 and "job 101 merges" in refused.stderr
    # Without an answer nobody knows what is in the queue.
    (site.folder / "fakes" / "mute").touch()
    refused = site.submit("--shards", "3")
    assert refused.returncode == 1 and "squeue failed" in refused.stderr
    assert len(site.calls("sbatch")) == 2


@pytest.mark.parametrize(
    "arguments, message",
    [
        (("--shards", "4"), "whose shards is 3, and not 4"),
        (("--shards", "3", "--seed", "2"), "whose seed is of the scene, and not 2"),
        (("--shards", "3", "--replicas", "80"), "whose replicas is of the scene, and not 80"),
    ],
)
def test_another_experiment_does_not_go_into_the_same_folder(site, arguments, message):
    assert site.submit("--shards", "3").returncode == 0
    refused = site.submit(*arguments)
    assert refused.returncode == 2 and message in refused.stderr, refused
    assert len(site.calls("sbatch")) == 2


def test_a_changed_scene_is_another_experiment(site):
    assert site.submit("--shards", "3").returncode == 0
    (site.folder / "case two.toml").write_text("format = 1 \n")
    refused = site.submit("--shards", "3")
    assert refused.returncode == 2 and "case two.toml has changed since" in refused.stderr


def test_what_slurm_refuses_leaves_nothing(site):
    (site.folder / "fakes" / "refuse-1").touch()
    before = site.files()
    refused = site.submit("--shards", "3")
    assert refused.returncode == 1 and "Invalid account" in refused.stderr and "nothing was submitted" in refused.stderr
    assert site.files() == before and not (site.folder / "case two").exists()
    (site.folder / "fakes" / "refuse-3").touch()
    refused = site.submit("--shards", "4")
    assert refused.returncode == 1 and "its array 101 was cancelled" in refused.stderr
    assert site.calls("scancel") == [["101"]]


# --- One task of the array


class Task:
    """shard.sh as Slurm starts it."""

    def __init__(self, site: Site, *run: str, scratch: str = "", shards: int = 12, save_before: int = 4, copy_every: str = "300", **environment: str):
        self.site = site
        self.shards = site.folder / "case two" / "shards"
        self.shards.mkdir(parents=True, exist_ok=True)
        self.shard = self.shards / "03.shard"
        slurm = {"SLURM_ARRAY_JOB_ID": "100", "SLURM_ARRAY_TASK_ID": "3", "SLURM_JOB_ID": "103", **environment}
        scene, output = site.folder / "case two.toml", site.folder / "case two"
        command = [SCRIPTS / "shard.sh", output, site.folder / "stiction", scene, str(shards), str(save_before), copy_every, scratch, *run]
        self.log = site.folder / "calls" / "log"
        site.tasks.append(self)
        with self.log.open("a") as log:
            self.process = subprocess.Popen(command, cwd=output, env={**site.environment, **slurm}, stdout=log, stderr=log, start_new_session=True)

    def wait_until(self, ready) -> None:
        deadline = time.monotonic() + 20
        while not ready():
            assert time.monotonic() < deadline, self.log.read_text()
            time.sleep(0.01)

    def code(self) -> int:
        return self.process.wait(timeout=40)

    def kept(self) -> int:
        path = self.shards / "03.shard.partial"
        return path.stat().st_size if path.exists() else 0

    def program(self) -> int:
        """The process of the program that computes the shard."""
        for stat in Path("/proc").glob("[0-9]*/stat"):
            with contextlib.suppress(OSError):
                name, state = stat.read_text().split("(", 1)[1].rsplit(")", 1)
                if name == "stiction" and int(state.split()[2]) == self.process.pid:
                    return int(stat.parent.name)
        raise AssertionError(f"no program runs:\n{self.log.read_text()}")

    def end(self) -> None:
        """As Slurm does: whatever is in the job."""
        os.killpg(self.process.pid, signal.SIGKILL)


@pytest.fixture
def behaves(site):
    return lambda text: (site.folder / "fakes" / "behaviour").write_text(text)


def test_a_task_computes_its_shard(site):
    task = Task(site, "--seed", "7", SLURM_CPUS_PER_TASK="4")
    assert task.code() == 0, task.log.read_text()
    (call,) = site.calls("stiction")
    scene = str(site.folder / "case two.toml")
    assert call == ["run", scene, "--shard", "3/12", "-o", str(task.shard), "--resume", "--threads", "4", "--quiet", "--seed", "7"]
    assert [path.name for path in task.shards.iterdir()] == ["03.shard"]


def test_a_task_is_requeued_at_its_time_limit_and_resumes(site):
    task = Task(site)
    task.wait_until(lambda: task.kept() > 5)
    task.process.send_signal(signal.SIGUSR1)
    task.wait_until(lambda: site.calls("scontrol"))
    # The task of the array, not the array.
    assert site.calls("scontrol") == [["requeue", "100_3"]]
    assert task.process.poll() is None, "Slurm is to end it"
    task.end()
    kept = task.kept()
    assert 5 < kept < 40 and not task.shard.exists()
    task = Task(site, SLURM_RESTART_COUNT="1")
    assert task.code() == 0
    assert f"goes on: {kept} of 40 are done (03.shard.partial)" in task.log.read_text()
    assert site.signals() == 1
    assert task.shard.exists() and task.kept() == 0


def test_a_cancelled_task_saves_and_is_not_requeued(site):
    task = Task(site)
    task.wait_until(lambda: task.kept() > 5)
    os.killpg(task.process.pid, signal.SIGTERM)
    assert task.code() == 130 and not site.calls("scontrol")
    assert 5 < task.kept() < 40


# Answers a signal at once, as a shell does not, and ends a second after the first.
ANSWERS = """exec python3 -c '
import signal, sys, time
answers = []
def answer(*_):
    answers.append(print("term", file=open(sys.argv[1] + "/calls/signals", "a"), flush=True))
signal.signal(signal.SIGTERM, answer)
print("ready", file=open(sys.argv[1] + "/calls/ready", "w"), flush=True)
# A pause would miss a signal that comes before it.
while not answers:
    time.sleep(0.02)
time.sleep(1)
sys.exit(130)
' "$here"
"""


def test_a_program_that_saves_gets_no_second_signal(site, behaves):
    """Slurm sends a TERM to all processes of a job; a second one would keep the program from saving."""
    behaves(ANSWERS)
    task = Task(site)
    task.wait_until((site.folder / "calls" / "ready").exists)
    os.killpg(task.process.pid, signal.SIGTERM)
    assert task.code() == 130 and site.signals() == 1


def test_a_signal_to_the_batch_shell_alone_reaches_the_program(site, behaves):
    behaves("while [[ ! $ends ]]; do sleep 0.05; done; exit 130")
    task = Task(site)
    task.wait_until(lambda: site.calls("stiction"))
    time.sleep(0.3)
    task.process.send_signal(signal.SIGTERM)
    assert task.code() == 130 and site.signals() == 1 and not site.calls("scontrol")


def test_a_task_without_progress_is_not_requeued_for_ever(site, behaves):
    behaves("while [[ ! $ends ]]; do sleep 0.05; done; exit 130")
    task = Task(site)
    task.wait_until(lambda: site.calls("stiction"))
    time.sleep(0.3)
    task.process.send_signal(signal.SIGUSR1)
    assert task.code() == 1 and not site.calls("scontrol")
    assert "not one batch" in task.log.read_text()


def test_a_batch_that_takes_too_long_is_given_up(site, behaves):
    # The first signal is not answered, the second is.
    keeps = 'printf xx >>"$output.partial"; '
    behaves(keeps + 'while [[ $(wc -l <"$here/calls/signals") != 2 ]]; do sleep 0.1; done; exit 130')
    (site.folder / "calls" / "signals").touch()
    task = Task(site)
    task.wait_until(lambda: task.kept())
    begin = time.monotonic()
    task.process.send_signal(signal.SIGUSR1)
    task.wait_until(lambda: site.calls("scontrol"))
    assert 1.5 < time.monotonic() - begin < 10
    task.end()


def test_a_killed_program_is_started_again_twice(site, behaves):
    keeps = 'printf xxxx >>"$output.partial"; '
    behaves(keeps + "((count > 10)) || kill -KILL $$")
    task = Task(site)
    assert task.code() == 137, "killed at 0, 4, and 8"
    assert task.log.read_text().count("was killed by signal 9: goes on") == 2 and [call[0] for call in site.calls("stiction")].count("run") == 3
    task = Task(site)
    assert task.code() == 0 and task.shard.exists()


@pytest.mark.parametrize("code", [1, 2])
def test_a_program_that_fails_fails_the_task(site, behaves, code):
    behaves(f"exit {code}")
    task = Task(site)
    assert task.code() == code and len(site.calls("stiction")) == 1
    assert f"ends with {code}; the submit command again" in task.log.read_text()


def test_a_requeued_task_waits_for_a_process_that_works_on_elsewhere(site, behaves):
    behaves('lock="${output%/*}/.${output##*/}.lock"; if [[ -e $lock ]]; then rm "$lock"; else touch "$lock"; exit 2; fi')
    task = Task(site, SLURM_RESTART_COUNT="1")
    assert task.code() == 0 and task.shard.exists()
    assert task.log.read_text().count("waits for the other process") == 1


def test_a_task_in_scratch_leaves_everything_in_the_shared_folder(site):
    scratch = site.folder / "scratch of the node"
    task = Task(site, scratch="$LOCAL/deep", LOCAL=str(scratch))
    task.wait_until(lambda: list(scratch.rglob("*.partial")))
    time.sleep(0.3)
    assert task.kept() == 0, "nothing in the shared folder yet"
    task.process.send_signal(signal.SIGUSR1)
    task.wait_until(lambda: site.calls("scontrol"))
    task.end()
    kept = task.kept()
    assert 2 < kept < 40 and not list((scratch / "deep").iterdir())
    # On another node.
    task = Task(site, scratch=str(site.folder / "other"), SLURM_RESTART_COUNT="1")
    assert task.code() == 0, task.log.read_text()
    assert f"goes on: {kept} of 40 are done (03.shard.partial)" in task.log.read_text()
    assert [path.name for path in task.shards.iterdir()] == ["03.shard"] and not list((site.folder / "other").iterdir())


def test_what_is_in_scratch_is_copied_now_and_then(site):
    task = Task(site, scratch=str(site.folder / "other"), copy_every="0.2")
    task.wait_until((task.shards / "03.shard.partial").exists)
    # The node is lost.
    task.end()
    kept = task.kept()
    assert 0 < kept < 40
    task = Task(site, scratch=str(site.folder / "another"), SLURM_RESTART_COUNT="1")
    assert task.code() == 0 and "goes on: " in task.log.read_text()
    assert [path.name for path in task.shards.iterdir()] == ["03.shard"]


def test_no_scratch_is_said(site):
    task = Task(site, scratch="$NOWHERE")
    assert task.code() == 1 and "$NOWHERE is not set on this node" in task.log.read_text()


# --- The merge


def test_the_merge_names_every_shard_and_validates(site):
    result = site.folder / "case two.h5"
    command = [SCRIPTS / "merge.sh", site.folder / "case two", site.folder / "stiction", result, "10"]
    subprocess.run(command, env=site.environment, check=True)
    merge, validate = site.calls("stiction")
    assert merge[:4] == ["merge", "-o", str(result), "--force"]
    assert merge[-10:] == [f"{site.folder}/case two/shards/{shard:02}.shard" for shard in range(1, 11)]
    assert validate == ["validate", str(result)]


# --- With the program itself


@pytest.mark.slow
@pytest.mark.parametrize("of_a_node", [False, True])
def test_shards_of_a_sweep_stop_and_go_on_to_the_same_bits(site, of_a_node):
    """Shards keep each point of a sweep by itself."""
    assert PROGRAM.is_file(), f"no program {PROGRAM}: run `cargo build --release` or set STICTION"
    shutil.copy(PROGRAM, site.folder / "stiction")
    text = (ROOT / "tests" / "data" / "quick.toml").read_text(encoding="utf-8")
    text = text.replace("replicas = 200", "replicas = 1200").replace('surface_height_std = "1.619 nm"\n', "")
    text += '\n[sweep]\nsurface.surface_height_std = ["1.2 nm", "1.5 nm", "1.8 nm"]\n'
    scene = site.folder / "case two.toml"
    scene.write_text(text, encoding="utf-8")
    subprocess.run([PROGRAM, "run", scene, "-o", "whole.h5", "--quiet"], cwd=site.folder, check=True, capture_output=True)

    scratch = str(site.folder / "scratch") if of_a_node else ""
    shards = site.folder / "case two" / "shards"
    shard = shards / "1.shard"
    kept = site.folder / "scratch" / "stiction-100_1" / "1.shard.points" if of_a_node else Path(f"{shard}.points")
    slurm = {"SLURM_ARRAY_TASK_ID": "1"}
    first = Task(site, "--checkpoint", "0.01", shards=2, scratch=scratch, **slurm)
    # The second of the three points, of which the first shard has one and a half.
    first.wait_until((kept / "0002.h5.partial").exists)
    # It waits for the signal, however fast it is.
    program = first.program()
    os.kill(program, signal.SIGSTOP)
    first.process.send_signal(signal.SIGUSR1)
    first.wait_until(lambda: "the time limit is near" in first.log.read_text())
    time.sleep(0.5)
    os.kill(program, signal.SIGCONT)
    first.wait_until(lambda: site.calls("scontrol"))
    first.end()
    assert not shard.exists() and sorted(path.name for path in Path(f"{shard}.points").iterdir()) == ["0001.h5", "0002.h5.partial"]
    for task in ("1", "2"):
        assert Task(site, shards=2, scratch=scratch, SLURM_ARRAY_TASK_ID=task).code() == 0
    assert re.search(r"goes on: 1200 of 1200 are done.* \(0001\.h5\)$", first.log.read_text(), re.MULTILINE)
    assert sorted(path.name for path in shards.iterdir()) == ["1.shard", "2.shard"]

    result = site.folder / "case two.h5"
    command = [SCRIPTS / "merge.sh", site.folder / "case two", site.folder / "stiction", result, "2"]
    merged = subprocess.run(command, env=site.environment, capture_output=True, text=True)
    assert merged.returncode in (0, 3), merged
    assert contents(result) == contents(site.folder / "whole.h5")


def test_shellcheck_finds_nothing():
    if not shutil.which("shellcheck"):
        pytest.skip("no shellcheck")
    subprocess.run(["shellcheck", *SCRIPTS.glob("*.sh")], check=True)

# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""The commands as functions: the same files, progress, Ctrl-C."""
import os
import pathlib
import signal
import threading
import time

import pytest

import pcavr

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def tabletop(tmp_path_factory, command):
    folder = tmp_path_factory.mktemp("tabletop")
    done = command("simulate", "tabletop", "-o", folder / "recording", "--duration", "1")
    assert done.returncode == 0, done.stderr
    return folder / "recording"


@pytest.fixture(scope="module")
def scene(push_folder, tmp_path_factory):
    folder = tmp_path_factory.mktemp("push-scene") / "scene"
    return pcavr.build(push_folder, folder)


def files_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(pathlib.Path(folder).rglob("*")) if path.is_file()}


def test_scene_has_the_bytes_of_the_command(tabletop, tmp_path, command):
    stages = []
    built = pcavr.build(tabletop, tmp_path / "by_python", voxel=0.01, threads=2,
                        options={"build.min_island": 0.001},
                        progress=lambda stage, done, total: stages.append((stage, done, total)))
    config = tmp_path / "config.yaml"
    config.write_text("build:\n  min_island: 0.001\n")
    done = command("--config", config, "build", tabletop, "-o", tmp_path / "by_command", "--voxel", "0.01")
    assert done.returncode == 0, done.stderr
    by_command = files_of(tmp_path / "by_command")
    assert files_of(tmp_path / "by_python") == by_command and "scene.glb" in by_command
    assert built.is_scanned and built.voxel_size == 0.01 and built.objects[0].pose.shape == (7,)
    assert {stage for stage, _, _ in stages} and all(isinstance(stage, str) for stage, _, _ in stages)


def test_exception_of_the_callback_ends_the_call(tabletop, tmp_path):
    def stop(stage, done, total):
        raise LookupError(stage)
    with pytest.raises(LookupError):
        pcavr.build(tabletop, tmp_path / "scene", progress=stop)
    assert not list(tmp_path.iterdir())


def test_ctrl_c_ends_a_build_and_leaves_nothing(tabletop, tmp_path):
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        pcavr.build(tabletop, tmp_path / "scene", voxel=0.002)
    timer.join()
    assert not list(tmp_path.iterdir())


def test_other_threads_run_during_a_build(tabletop, tmp_path):
    thread = threading.Thread(target=pcavr.build, args=(tabletop, tmp_path / "scene"))
    thread.start()
    turns, begin = 0, time.perf_counter()
    while thread.is_alive():
        turns += 1
        time.sleep(0.001)
    thread.join()
    # With the lock held during the build there would be a handful of turns.
    assert turns > 50 * (time.perf_counter() - begin)
    assert (tmp_path / "scene" / "scene.yaml").exists()


def test_build_identify_replay_evaluate_export(scene, push_folder, tmp_path, command):
    identified = pcavr.identify_recording(push_folder, scene=scene.folder)
    run = tmp_path / "run"
    notes = pcavr.replay(push_folder, scene.folder, run, parameters=identified.parameters,
                         forward_delay=0.2, backward_delay=0.2)
    assert isinstance(notes, list) and (run / "run.yaml").exists()
    report = pcavr.evaluate(run, push_folder / "truth", output=tmp_path / "report")
    assert report["headline"] and (tmp_path / "report" / "report.json").exists()
    assert pcavr.evaluate(run)["headline"]
    warnings = pcavr.export(scene.folder, tmp_path / "world", "mjcf", parameters=identified.parameters,
                            motion=push_folder)
    assert isinstance(warnings, list)
    assert {"scene.xml", "motion.csv", "run.py"} <= set(files_of(tmp_path / "world"))


@pytest.mark.parametrize("format", ["mjcf", "urdf", "sdf", "usd", "moveit", "gltf", "ply", "obj", "stl",
                                    "3dtiles"])
def test_export_has_the_bytes_of_the_command(format, scene, tmp_path, command):
    is_engine = format in ("mjcf", "urdf", "sdf", "usd")
    pcavr.export(scene.folder, tmp_path / "by_python", format, assume=is_engine)
    done = command("export", scene.folder, "--to", format, *(["--assume"] if is_engine else []),
                   "-o", tmp_path / "by_command")
    assert done.returncode == 0, done.stderr
    assert files_of(tmp_path / "by_python") == files_of(tmp_path / "by_command")


def test_data_set_has_the_bytes_of_the_command(push_folder, tmp_path, command):
    stages = []
    frames = pcavr.export_lerobot(push_folder, tmp_path / "by_python", fps=20,
                                  progress=lambda *stage: stages.append(stage))
    assert stages[-1] == ("episodes", 1, 1)
    done = command("export", push_folder, "--to", "lerobot", "--fps", "20", "-o", tmp_path / "by_command")
    assert done.returncode == 0, done.stderr
    assert f"{frames} frames" in done.stdout
    assert files_of(tmp_path / "by_python") == files_of(tmp_path / "by_command")


def test_run_has_the_bytes_of_the_command(scene, push_folder, tmp_path, command):
    identified = pcavr.identify_recording(push_folder, scene=scene.folder)
    pcavr.write_parameters(tmp_path / "parameters.yaml", identified.parameters)
    pcavr.replay(push_folder, scene.folder, tmp_path / "by_python",
                 parameters=tmp_path / "parameters.yaml", forward_delay=0.1)
    done = command("replay", push_folder, "--scene", scene.folder, "--parameters",
                   tmp_path / "parameters.yaml", "--forward-delay", "0.1", "-o", tmp_path / "by_command")
    assert done.returncode == 0, done.stderr
    assert files_of(tmp_path / "by_python") == files_of(tmp_path / "by_command")


def test_bad_arguments(scene, push_folder, tmp_path):
    with pytest.raises(pcavr.Error):
        pcavr.build(tmp_path / "absent", tmp_path / "scene")
    with pytest.raises(pcavr.Error):
        pcavr.build(push_folder, push_folder / "scene")
    with pytest.raises(pcavr.Error):
        pcavr.build(push_folder, tmp_path / "scene", voxel=1e9)
    with pytest.raises(pcavr.Error, match="threads"):
        pcavr.build(push_folder, tmp_path / "scene", threads=-1)
    with pytest.raises(TypeError, match="progress"):
        pcavr.build(push_folder, tmp_path / "scene", progress=3)
    with pytest.raises(pcavr.Error):
        pcavr.replay(push_folder, tmp_path / "absent", tmp_path / "run")
    with pytest.raises(pcavr.Error):
        pcavr.replay(push_folder, scene.folder, tmp_path / "run", forward_delay=float("nan"))
    with pytest.raises(pcavr.Error):
        pcavr.evaluate(push_folder, push_folder / "truth")
    with pytest.raises(pcavr.Error, match="format"):
        pcavr.export(scene.folder, tmp_path / "world", "vrml")
    with pytest.raises(pcavr.Error, match="friction"):
        pcavr.export(scene.folder, tmp_path / "world", "obj", assume=True)
    with pytest.raises(pcavr.Error, match="fps"):
        pcavr.export_lerobot(push_folder, tmp_path / "set", fps=0)
    with pytest.raises(pcavr.Error, match="recordings"):
        pcavr.export_lerobot([], tmp_path / "set")
    with pytest.raises(pcavr.Error):
        pcavr.simulate("nothing", tmp_path / "recording")
    with pytest.raises(pcavr.Error):
        pcavr.read_scene(push_folder)
    assert not list(tmp_path.iterdir())

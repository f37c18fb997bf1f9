# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Parameter files, read, changed and written."""
import math

import pytest

import pcavr


def make_table():
    box = pcavr.Parameters()
    box.mass = pcavr.Value(1.25, 0.01)
    box.sliding_friction_coefficient = pcavr.Value(0.31, std=0.004)
    box.contact_stiffness = pcavr.Value(2.5e4)
    box.contact_exponent = pcavr.Value(1.5)
    return {"box": box}


def test_written_table_is_read_back(tmp_path):
    file = tmp_path / "parameters.yaml"
    pcavr.write_parameters(file, make_table(), comment="by hand")
    assert file.read_text().startswith("# by hand")
    box = pcavr.read_parameters(file)["box"]
    assert (box.mass.value, box.mass.std) == (1.25, 0.01)
    assert float(box.sliding_friction_coefficient) == 0.31
    assert box.contact_stiffness == pcavr.Value(2.5e4)
    assert box.viscous_friction is None
    assert list(box.known()) == ["mass", "sliding_friction_coefficient", "contact_stiffness",
                                 "contact_exponent"]


def test_known_parameters_are_those_of_the_text():
    table = pcavr.parse_parameters("box:\n  mass: 2.0\n  mass_std: 0.5\n")
    assert table["box"].known() == {"mass": pcavr.Value(2.0, 0.5)}


def test_value_is_immutable_so_that_no_change_is_lost():
    box = make_table()["box"]
    with pytest.raises(AttributeError):
        box.mass.value = 2.0
    box.mass = None
    assert box.mass is None


@pytest.mark.parametrize("value, std", [(math.nan, None), (math.inf, None), (1.0, -0.1), (1.0, math.nan)])
def test_value_that_is_not_finite(value, std):
    with pytest.raises(pcavr.Error):
        pcavr.Value(value, std)


def test_value_out_of_range_is_not_written(tmp_path):
    table = make_table()
    table["box"].mass = pcavr.Value(-1.0)
    with pytest.raises(pcavr.Error, match="mass"):
        pcavr.write_parameters(tmp_path / "parameters.yaml", table)
    assert not list(tmp_path.iterdir())


def test_existing_files_are_not_replaced_unasked(tmp_path):
    file = tmp_path / "parameters.yaml"
    pcavr.write_parameters(file, make_table())
    with pytest.raises(pcavr.Error):
        pcavr.write_parameters(file, make_table())
    pcavr.write_parameters(file, make_table(), replace=True)
    other = tmp_path / "diary.txt"
    other.write_text("not parameters")
    with pytest.raises(pcavr.Error):
        pcavr.write_parameters(other, make_table(), replace=True)
    assert other.read_text() == "not parameters"


def test_wrong_types():
    with pytest.raises(TypeError):
        pcavr.write_parameters("file", {"box": 1.0})
    with pytest.raises(TypeError):
        pcavr.Parameters().mass = "heavy"


def test_surface_offset_is_a_vector():
    box = pcavr.Parameters()
    box.contact_surface_offset = [0.001, 0, 0]
    assert box.contact_surface_offset.tolist() == [0.001, 0, 0]
    with pytest.raises(pcavr.Error, match="contact_surface_offset"):
        box.contact_surface_offset = [1.0, 2.0]

"""A studio under attack: a little of what reliability/attack.py does to it."""

from __future__ import annotations

import pytest

from reliability.attack import knock, rave
from reliability.canary import Canary
from reliability.hostile import asked
from reliability.siege import studio


@pytest.fixture(scope="module")
def besieged():
    with studio() as target:
        yield target


def test_the_canary_sings(tmp_path):
    (tmp_path / "secret").write_text("x")
    canary = Canary(tmp_path)
    assert canary.touched() == []
    (tmp_path / "secret").read_text()
    assert "secret" in canary.touched()
    canary.close()


def test_every_command_is_attacked():
    commands = asked()
    assert {"points.set", "open.path", "upload.chunk"} <= set(commands)
    assert commands["open.path"] == {"path": "text"}
    assert sum(bool(fields) for fields in commands.values()) > 40


def test_nobody_reads_outside_the_root_and_the_studio_lives(besieged):
    canary = Canary(besieged.folder / "secret")
    requests, frames = knock(besieged, 120, seed=1), rave(besieged, 200, seed=1)
    assert canary.touched() == []
    canary.close()
    assert requests.leaked == frames.leaked == 0
    assert not frames.bugs, frames.bugs
    assert besieged.process.poll() is None
    assert besieged.get("/alive").status == 204
    assert not besieged.complaints()


def test_the_folder_itself_is_served(besieged):
    """Else nothing would be learnt from what is refused."""
    from pliant.studio.serving.frames import Frame

    with besieged.connect() as link:
        link.send(Frame({"id": 7, "do": "open.path", "with": {"path": "box.off"}}).encode())
        while (head := Frame.decode(link.recv(timeout=30)).head).get("answer") != 7:
            pass
        assert "error" not in head

"""Who may talk to the studio, and what nobody can make it do."""

import http.client
import itertools
import socket
import time
from functools import cached_property
from threading import Event
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest
from bodies_to_edit import round_scene
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from pliant.errors import PliantError
from pliant.studio.serving.files import MOST_BYTES, inside, safe_name
from pliant.studio.serving.frames import Frame


class Visitor:
    """A program that talks to a studio: with its key, or without."""

    def __init__(self, studio):
        self.studio, self.port = studio, studio.port
        self.token = parse_qs(urlsplit(studio.url).query)["token"][0]

    def get(self, path="/", method="GET", **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        host = headers.pop("host", f"127.0.0.1:{self.port}")
        connection.putrequest(method, path, skip_host=True)
        for name, value in {"host": host, **headers}.items():
            connection.putheader(name, value)
        connection.endheaders()
        answer = connection.getresponse()
        answer.read()
        connection.close()
        return answer

    @cached_property
    def cookie(self):
        return self.get(f"/?token={self.token}").getheader("set-cookie").split(";")[0]

    def socket(self, origin="own", cookie=None, host=None):
        headers = {"cookie": self.cookie if cookie is None else cookie}
        if host is not None:
            headers["host"] = host
        if origin is not None:
            headers["origin"] = f"http://127.0.0.1:{self.port}" if origin == "own" else origin
        return connect(f"ws://127.0.0.1:{self.port}/socket", additional_headers=headers, max_size=None, open_timeout=10)


@pytest.fixture(scope="module")
def visitor(tmp_path_factory):
    from pliant.studio.serving.launching import launch

    folder = tmp_path_factory.mktemp("studio")
    studio = launch(round_scene(), "ring", port=0, root=folder, autosave=folder / "state")
    studio.start()
    yield Visitor(studio)
    studio.stop()


def answer_to(link, **command):
    """The answer to a command, events passed over."""
    number = next(_numbers)
    arrays = command.pop("arrays", {})
    link.send(Frame({"id": number, **command}, arrays).encode())
    while True:
        frame = Frame.decode(link.recv(timeout=10))
        if frame.head.get("answer") == number:
            return frame


def ended(link, *messages):
    """The code with which a connection ends after some messages; None where it ends without a word."""
    try:
        for message in messages:
            link.send(message)
        while True:
            link.recv(timeout=10)
    except ConnectionClosed as closed:
        return None if closed.rcvd is None else closed.rcvd.code


_numbers = itertools.count(1)


def test_it_listens_on_this_machine_only(visitor):
    assert visitor.studio._socket.getsockname()[0] == "127.0.0.1"
    for _, _, _, _, address in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET, socket.SOCK_STREAM):
        if not address[0].startswith("127."):
            with pytest.raises(ConnectionError):
                socket.create_connection((address[0], visitor.port), timeout=2).close()


@pytest.mark.parametrize("path", ["/", "/alive", "/assets/index.js", "/?token=wrong", "/alive?token=wrong"])
def test_nothing_is_served_without_the_key(visitor, path):
    assert visitor.get(path).status == 401


def test_the_key_is_good_for_a_cookie_that_no_script_reads_and_no_site_sends(visitor):
    answer = visitor.get(f"/?token={visitor.token}")
    cookie = answer.getheader("set-cookie").lower()
    assert answer.status == 303
    assert answer.getheader("location") == "/"
    assert "httponly" in cookie
    assert "samesite=strict" in cookie
    assert visitor.token not in cookie
    assert visitor.get("/", cookie=visitor.cookie).status == 200
    assert visitor.get(f"/alive?token={visitor.token}").status == 401  # it opens the door, nothing else


def test_every_answer_has_the_policy(visitor):
    for answer in (visitor.get("/", cookie=visitor.cookie), visitor.get("/")):
        policy = answer.getheader("content-security-policy")
        assert "default-src 'self'" in policy
        assert "unsafe" not in policy
        assert answer.getheader("x-content-type-options") == "nosniff"


@pytest.mark.parametrize("host", ["evil.example", "evil.example:8477", "127.0.0.1.evil.example", ""])
def test_a_rebound_name_is_refused(visitor, host):
    assert visitor.get("/", host=host, cookie=visitor.cookie).status in (400, 421)
    with pytest.raises((InvalidStatus, OSError)):
        visitor.socket(origin=f"http://{host}", host=host)


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", "file://"])
def test_another_origin_is_refused(visitor, origin):
    assert visitor.get("/alive", cookie=visitor.cookie, origin=origin).status == 403
    with pytest.raises(InvalidStatus) as refused:
        visitor.socket(origin=origin)
    assert refused.value.response.status_code == 403


def test_a_socket_without_an_origin_is_refused(visitor):
    with pytest.raises(InvalidStatus):
        visitor.socket(origin=None)


@pytest.mark.parametrize("cookie", ["", "pliant_studio=x", "pliant_studio_1=y"])
def test_a_socket_without_the_cookie_is_refused(visitor, cookie):
    with pytest.raises(InvalidStatus):
        visitor.socket(cookie=cookie)


@pytest.mark.parametrize(
    "path", ["/assets/../index.html", "/assets/..%2f..%2fserver.py", "/assets/%2e%2e/%2e%2e/guard.py"]
)
def test_no_path_leads_out_of_the_page_s_files(visitor, path):
    assert visitor.get(path, cookie=visitor.cookie).status in (400, 404)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\xff",
        b"\xff\xff\xff\xff",
        b"\x02\x00\x00\x00[]",
        b"\x05\x00\x00\x00{nope",
        Frame({"id": "x"}).encode(),
        Frame({"id": 1, "do": 5}).encode(),
        b'\x4a\x00\x00\x00{"id":1,"do":"a","with":{},"arrays":[{"name":"x","type":"f8","length":99}]}',
        b'\x4a\x00\x00\x00{"id":1,"do":"a","with":{},"arrays":[{"name":"x","type":"O8","length":-9}]}',
    ],
)
def test_a_malformed_frame_ends_the_connection_and_nothing_else(visitor, data):
    with visitor.socket() as link:
        assert ended(link, data) == 1007
    with visitor.socket() as link:
        assert "error" not in answer_to(link, do="history.undo", **{"with": {}}).head


def test_text_is_no_frame(visitor):
    with visitor.socket() as link:
        assert ended(link, "hello") == 1007


def test_a_message_that_is_too_long_ends_the_connection(visitor):
    with visitor.socket() as link:
        # What is unread when the server closes may reset the connection before its code arrives.
        assert ended(link, bytes(5 << 20)) in (None, 1009)
    with visitor.socket() as link:
        assert "error" not in answer_to(link, do="history.undo", **{"with": {}}).head


def test_a_flood_ends_the_connection_and_the_session_lives(visitor):
    with visitor.socket() as link:
        flood = [Frame({"id": number, "do": "nothing"}).encode() for number in range(6000)]
        assert ended(link, *flood) in (None, 1008)
    with visitor.socket() as link:
        assert (
            "upload" in answer_to(link, do="upload.begin", **{"with": {"files": [{"name": "a.off", "size": 1}]}}).head
        )


def test_what_is_not_finite_does_not_arrive(visitor):
    before = visitor.studio.session.scene
    frame = Frame({"id": 1, "do": "points.set", "with": {"layer": "Lattice"}}, {"positions": np.full(3, np.nan)})
    with visitor.socket() as link:
        assert ended(link, frame.encode()) == 1007
    assert visitor.studio.session.scene is before


@pytest.mark.parametrize(
    ("command", "values"),
    [
        ("nothing", {}),
        ("points.set", {"layer": "Lattice"}),
        ("points.get", {"layer": "no such"}),
        ("points.get", {}),
        ("layers.add", {"kind": "__import__"}),
        ("layers.fields", {"layer": "Lattice", "fields": {"carrier": 1}}),
        ("layers.fields", {"layer": "Lattice", "fields": {"edge": [1, 2]}}),
        ("layers.move", {"layer": "Lattice", "index": 10**9}),
        ("lattice.add", {"basis": "bspline", "shape": [10**6, 10**6, 10**6]}),
        ("lattice.add", {"basis": "bspline", "shape": [0, 1, 1]}),
        ("upload.begin", {"files": []}),
        ("upload.begin", {"files": [{"name": "a.obj", "size": 10**12}]}),
        ("upload.begin", {"files": [{"name": "../../a.obj", "size": -1}]}),
        ("open.upload", {"upload": "../.."}),
        ("open.path", {"path": "../../etc/passwd"}),
        ("open.path", {"path": "/etc/passwd"}),
        ("folder.list", {"folder": ".."}),
        ("open.recover", {"name": "../x.pliant"}),
        ("mesh.texture", {"id": 7}),
        ("export.mesh", {"suffix": "/../../x.obj"}),
        ("drag.move", {}),
        ("pull.begin", {"layer": "Lattice", "triangle": [0, 1, 10**9], "point": [0, 0, 0]}),
        ("field.color", {"quantity": "secrets"}),
        ("field.lines", {"slice": "w"}),
    ],
)
def test_a_command_that_cannot_be_done_says_why(visitor, command, values):
    before = visitor.studio.session.scene
    with visitor.socket() as link:
        error = answer_to(link, do=command, **{"with": values}).head["error"]
    assert error["kind"] not in ("Bug", "OSError")
    assert error["message"]
    assert visitor.studio.session.scene is before


def test_links_do_not_lead_out_of_the_folder(tmp_path):
    root, secret = tmp_path / "root", tmp_path / "secret.off"
    root.mkdir()
    secret.write_text("OFF\n")
    (root / "link.off").symlink_to(secret)
    for name in ("link.off", "../secret.off", str(secret), "a/../../secret.off", "\0"):
        with pytest.raises(PliantError):
            inside(root.resolve(), name)
    assert inside(root.resolve(), "a.off") == root.resolve() / "a.off"


def test_an_uploaded_file_keeps_its_last_name_only():
    assert safe_name("../../x.obj") == "x.obj"
    assert safe_name("C:\\Users\\me\\x.obj") == "x.obj"
    for name in ("", "..", "a\nb", "a" * 300, "<x>"):
        with pytest.raises(PliantError):
            safe_name(name)


def test_an_upload_cannot_grow_beyond_what_it_announced(visitor):
    with visitor.socket() as link:
        files = [{"name": "a.off", "size": 4}]
        upload = answer_to(link, do="upload.begin", **{"with": {"files": files}}).head["upload"]
        values = {"upload": upload, "file": 0}
        for data, fails in ((b"OFF\n", False), (b"x", True)):
            arrays = {"bytes": np.frombuffer(data, np.uint8)}
            answer = answer_to(link, do="upload.chunk", arrays=arrays, **{"with": values})
            assert ("error" in answer.head) is fails
    assert MOST_BYTES == 256 << 20


def test_an_obj_shows_no_pictures_from_elsewhere(visitor, tmp_path):
    from PIL import Image

    secret = tmp_path / "secret.png"
    Image.new("RGB", (4, 4)).save(secret)
    contents = {
        "a.obj": "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n",
        "a.mtl": f"newmtl m\nmap_Kd {secret}\n",
    }
    with visitor.socket() as link:
        files = [{"name": name, "size": len(text)} for name, text in contents.items()]
        upload = answer_to(link, do="upload.begin", **{"with": {"files": files}}).head["upload"]
        for at, text in enumerate(contents.values()):
            arrays = {"bytes": np.frombuffer(text.encode(), np.uint8)}
            answer_to(link, do="upload.chunk", arrays=arrays, **{"with": {"upload": upload, "file": at}})
        assert "error" not in answer_to(link, do="open.upload", **{"with": {"upload": upload}}).head
        assert "error" in answer_to(link, do="mesh.texture", **{"with": {"id": 0}}).head


def test_a_page_that_goes_gives_up_its_drag(visitor):
    session = visitor.studio.session
    session.submit(session.begin, round_scene(), "ring").result()
    with visitor.socket() as first, visitor.socket() as second:
        assert "error" not in answer_to(first, do="drag.begin", **{"with": {"layer": "Lattice"}}).head
        refused = answer_to(second, do="drag.begin", **{"with": {"layer": "Lattice"}}).head["error"]
        assert "another page" in refused["message"]
        first.close()
        end = time.monotonic() + 10
        while "error" in answer_to(second, do="drag.begin", **{"with": {"layer": "Lattice"}}).head:
            assert time.monotonic() < end
            time.sleep(0.05)


def test_what_only_reads_is_answered_while_an_edit_takes_long(visitor):
    held, asked = Event(), {"do": "folder.list", "with": {"folder": ""}}
    with visitor.socket() as link:
        before = answer_to(link, **asked).head  # it has joined
        edit = visitor.studio.session.submit(held.wait, 30)
        try:
            assert answer_to(link, **asked).head["files"] == before["files"]
            assert not edit.done()
        finally:
            held.set()

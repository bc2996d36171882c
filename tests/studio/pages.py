"""Pages without a browser: what they were sent, and what they ask for."""

from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session


class Page:
    """A page that remembers what it was sent."""

    def __init__(self):
        self.frames = []

    def send(self, data):
        self.frames.append(Frame.decode(data))

    def events(self, name):
        return [frame for frame in self.frames if frame.head.get("event") == name]

    def ask(self, session, command, values=None, **arrays):
        answer = self._told(session, command, values, arrays)
        assert "error" not in answer.head, answer.head
        return answer

    def refused(self, session, command, values=None, **arrays):
        """The error of a command that is refused."""
        return self._told(session, command, values, arrays).head["error"]

    def _told(self, session, command, values, arrays):
        session.handle(self, Frame({"id": 1, "do": command, "with": values or {}}, arrays).encode())
        return next(frame for frame in reversed(self.frames) if "answer" in frame.head)


def joined(scene, name):
    """A session on a scene and a page that looks at it; ended when the test is."""
    import pliant.studio.commands  # noqa: F401

    session, page = Session(scene, name), Page()
    session.join(page)
    yield session, page
    session.end()

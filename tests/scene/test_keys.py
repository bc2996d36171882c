"""Keys of arrays: what is equal has the same key, and what somebody may still write is looked at each time."""

import numpy as np

from pliant.scene.keys import array_key

MANY = 20_000  # numbers: enough to be remembered


def test_equal_arrays_have_one_key_however_they_are_held():
    values = np.random.default_rng(0).normal(size=MANY)
    own = values.copy()
    own.flags.writeable = False
    read = np.frombuffer(values.tobytes())  # as files are read: a view of bytes
    assert array_key(values) == array_key(own) == array_key(read)
    assert array_key(values) != array_key(values.reshape(2, -1))
    assert array_key(values) != array_key(values.astype(np.float32))


def test_a_read_only_view_of_what_can_be_written_is_looked_at_again():
    values = np.zeros(MANY)
    view = values.view()
    view.flags.writeable = False
    before = array_key(view)
    values[7] = 1
    assert array_key(view) != before

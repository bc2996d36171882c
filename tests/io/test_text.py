"""Numbers come out of text correctly rounded, and go in as the shortest that come out the same."""

import random
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import UnreadableFile
from pliant.io.mesh_formats.format import Source
from pliant.io.text import Lines, bytes_of, number_text, patched, plain_text, read_numbers, text_of


def numbers(words):
    text = b" ".join(words) + b"\n"
    source = Source(text, "numbers.txt")
    return read_numbers(source, Lines.of(plain_text(source)), len(words), body=False).values


@settings(deadline=None, max_examples=60)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=40))
def test_every_double_survives_in_every_notation(values):
    for form in ("{!r}", "{:.17g}", "{:.16e}", "{:.25e}", "{:+.17g}"):
        assert numbers([form.format(value).encode() for value in values]).tobytes() == struct.pack(
            f"{len(values)}d", *(float(form.format(value)) for value in values)
        )


def test_random_decimals_round_as_pythons_float_does():
    rng = random.Random(7)
    words = []
    for _ in range(20_000):
        digits = "".join(rng.choice("0123456789") for _ in range(rng.randint(1, 24)))
        point = rng.randint(0, len(digits))
        exponent = rng.choice(["", f"e{rng.randint(-40, 40)}", f"E+{rng.randint(0, 120)}", f"e-{rng.randint(0, 330)}"])
        words.append(f"{rng.choice(['', '-', '+'])}{digits[:point]}.{digits[point:]}{exponent}".encode())
    expected = np.array([float(word) for word in words])
    assert numbers(words).tobytes() == expected.tobytes()


@pytest.mark.parametrize(
    "word",
    [
        b"9007199254740993",  # halfway between two doubles: to even
        b"9007199254740992.9999999999999999",
        b"2.2250738585072011e-308",  # the slowest subnormal
        b"1.7976931348623157e308",
        b"5e-324",
        b"0.000000000000000000000000000000000000000000001",
        b"123456789012345678901234567890",
        b"-0.0",
        b"0e999",
        b"1.",
        b".5",
        b"1e23",
        b"8.5e-1",
    ],
)
def test_hard_cases_round_correctly(word):
    assert numbers([word]).tobytes() == np.array([float(word)]).tobytes()


@pytest.mark.parametrize(
    "word", [b"nan", b"inf", b"-inf", b"1e400", b"1_0", b"0x10", b"1,5", b"--1", b"e5", b".", b"1e", b"1.2.3"]
)
def test_what_is_no_finite_number_is_refused_with_its_line(word):
    text = b"1\n\n# comment\n2 " + word + b"\n"
    source = Source(text, "numbers.txt")
    lines = Lines.of(plain_text(source))
    with pytest.raises(UnreadableFile, match="line 4") as caught:
        read_numbers(source, lines, 2, body=False)
    assert caught.value.line == 4
    assert word[:10].decode() in str(caught.value)


@pytest.mark.parametrize("ending", [b"\n", b"\r\n", b"\r"])
def test_lines_end_in_three_ways_and_go_on_behind_a_backslash(ending):
    text = ending.join([b"\xef\xbb\xbfv 1 2 \\", b" 3", b"", b"# v 9 \\", b"V\t4 5 6 # tail", b""])
    source = Source(text, "lines.txt")
    lines = Lines.of(plain_text(source))
    assert read_numbers(source, lines[lines.where(b"v")], 3).values.tolist() == [1, 2, 3, 4, 5, 6]
    assert source.line(text.index(b"4 5")) == 5


@settings(deadline=None, max_examples=60)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=20), st.data())
def test_patching_changes_the_numbers_that_differ_and_nothing_else(values, data):
    old = np.array(values)
    text = b"# head\n" + b"  ;\t".join(b"%.17e" % value for value in values) + b" # tail"
    starts = [len(b"# head\n")]
    for value in values[:-1]:
        starts.append(starts[-1] + len(b"%.17e" % value) + len(b"  ;\t"))
    new = np.array(
        data.draw(st.lists(st.sampled_from([*values, 0.1, -0.0]), min_size=len(values), max_size=len(values)))
    )
    result = bytes(patched(text, np.array(starts), old, new))
    words = [
        b"%.17e" % a if a.tobytes() == b.tobytes() else repr(float(b)).encode() for a, b in zip(old, new, strict=True)
    ]
    found = result.removeprefix(b"# head\n").removesuffix(b" # tail").split(b"  ;\t")
    assert len(found) == len(words)
    for said, meant in zip(found, words, strict=True):
        assert said == meant or struct.pack("d", float(said)) == struct.pack("d", float(meant))
    unchanged = [i for i, (a, b) in enumerate(zip(old, new, strict=True)) if a.tobytes() == b.tobytes()]
    assert [found[i] for i in unchanged] == [words[i] for i in unchanged]


@given(st.binary())
def test_names_keep_their_bytes(raw):
    assert bytes_of(text_of(raw)) == raw


@settings(deadline=None)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False)))
def test_number_text_reads_back_the_same(values):
    words = number_text(np.array(values)).split(b",") if values else []
    assert [struct.pack("d", float(word)) for word in words] == [struct.pack("d", value) for value in values]


def test_text_of_two_bytes_a_character_is_named():
    with pytest.raises(UnreadableFile, match="UTF-16"):
        plain_text(Source("v 1 2 3\n".encode("utf-16"), "wide.obj"))

"""verdict as its users see it."""

import math
import os
import re
import stat
import struct
import subprocess
import unittest
from collections import Counter
from decimal import Context, Decimal
from fractions import Fraction
from pathlib import Path

import programs
from programs import ProgramTest, nearest

DATA = Path(__file__).parents[1] / "data"
PRECISIONS = ("baseline", "single", "double", "exact")
NUMBERS = [corner + axis for corner in "abcp" for axis in "xyz"] + ["R"]
HEADER = ",".join(["id", "family", *NUMBERS])
HIT = "0,0,0, 4,0,0, 0,4,0, 1,1,1, 1"  # it touches the face at exactly the radius
MISS = "0,0,0, 4,0,0, 0,4,0, 1,1,1, 0.5"


def rows_of(path):
    """The rows of a plain CSV file as dictionaries."""
    header, *lines = path.read_text().splitlines()
    return [dict(zip(header.split(","), line.split(","))) for line in lines]


class VerdictTest(ProgramTest):
    def verdicts(self, *args):
        """The verdicts that are written, with their ids, and what is printed."""
        printed = self.succeed("verdict", *args, "--output", "out.csv")
        return self.written(), printed

    def written(self):
        header, *lines = self.read("out.csv").decode().splitlines()
        self.assertEqual(header, "id,hit")
        pairs = [line.split(",") for line in lines]
        self.assertLessEqual({hit for _, hit in pairs}, {"0", "1"})
        return [(case, int(hit)) for case, hit in pairs]

    def hits(self, csv, *args):
        """The verdicts of a file with this content."""
        self.write("cases.csv", csv)
        return [hit for _, hit in self.verdicts("cases.csv", *args)[0]]

    def table(self, printed):
        """The numbers that are printed, by family; `total` is one of them."""
        header, *lines = printed.splitlines()
        found = {}
        for line in lines:
            family, *numbers = line.split()
            if numbers and all(n.isdigit() for n in numbers):
                found[family] = dict(zip(header.replace("false hits", "false_hits").split()[1:], map(int, numbers)))
        return found


class HardCases(VerdictTest):
    hard = (("static_f32.csv", "float"), ("static_f64.csv", "double"), ("swept_f32.csv", "float"))

    def test_exact_is_right_everywhere(self):
        for name, scalar in self.hard:
            truth = [(row["id"], int(row["hit"])) for row in rows_of(DATA / name)]
            self.assertIn(len(truth), (4785, 486, 645))
            found, printed = self.verdicts(DATA / name, "--scalar", scalar)  # exact is what one gets unasked
            self.assertEqual([pair for pair in zip(found, truth) if pair[0] != pair[1]], [])
            self.assertIn(f"\n0 of {len(truth)} verdicts differ from the column hit\n", printed)
            self.assertEqual(self.verdicts(DATA / name, "--scalar", scalar, "--precision", "exact"), (found, printed))

    def test_floats_are_doubles(self):
        for name in ("static_f32.csv", "swept_f32.csv"):
            found, _ = self.verdicts(DATA / name, "--scalar", "float")
            self.assertEqual(self.verdicts(DATA / name, "--scalar", "double")[0], found)

    def test_what_is_printed_is_what_differs(self):
        differing = {}
        for name, scalar in self.hard:
            truth = rows_of(DATA / name)
            for precision in PRECISIONS[name.startswith("swept"):]:  # which have no baseline
                found, printed = self.verdicts(DATA / name, "--scalar", scalar, "--precision", precision)
                self.assertEqual([case for case, _ in found], [row["id"] for row in truth])
                expected = {}
                for row, (_, hit) in zip(truth, found):
                    for family in (row["family"], "total"):
                        counts = expected.setdefault(family, Counter(rows=0, hits=0, differ=0, false_hits=0, misses=0))
                        counts.update(rows=1, hits=hit, differ=hit != int(row["hit"]), false_hits=hit > int(row["hit"]),
                                      misses=hit < int(row["hit"]))
                self.assertEqual(self.table(printed), expected)
                self.assertIn(f"{precision} precision, {scalar} coordinates", printed)
                differing[name, precision] = expected["total"]["differ"]
        for name in ("static_f32.csv", "static_f64.csv"):
            self.assertGreater(differing[name, "baseline"], differing[name, "double"])
        self.assertGreater(differing["swept_f32.csv", "single"], differing["swept_f32.csv", "double"])
        self.assertGreater(differing["static_f32.csv", "baseline"], 400)
        self.assertGreater(differing["static_f32.csv", "baseline"], differing["static_f32.csv", "single"])
        self.assertGreater(differing["static_f32.csv", "single"], differing["static_f32.csv", "double"])

    def test_every_space_gives_the_same(self):
        for name, scalar in self.hard:
            for precision in PRECISIONS[1:]:
                call = [DATA / name, "--scalar", scalar, "--precision", precision, "--output"]
                self.succeed("verdict", *call, "host.csv")
                for space in ("cuda", "cuda_shared"):
                    done = self.run_program("verdict", *call, "cuda.csv", "--space", space)
                    if done.returncode != 0:
                        self.fail_with(1, ["--space", "CUDA"], "verdict", *call, "cuda.csv", "--space", space)
                        self.skipTest("there is no CUDA device")
                    self.assertEqual(self.read("cuda.csv"), self.read("host.csv"), (name, precision, space))


class Forms(VerdictTest):
    def test_every_form(self):
        forms = {
            "plain": f"{HEADER}\n0,f,{HIT}\n1,f,{MISS}\n",
            "no final newline, CRLF": f"{HEADER}\r\n0,f,{HIT}\r\n1,f,{MISS}",
            "blank lines, a byte order mark": f"\ufeff\n{HEADER}\n\n0,f,{HIT}\n \n1,f,{MISS}\n\n",
            "quotes": f'"id","family",{",".join(NUMBERS)}\n"0","f, and g",{HIT}\n"1",f,{MISS}\n',
            "no family in some row": f"{HEADER}\n0,,{HIT}\n1,f,{MISS}\n",
            "hexadecimal": f"{HEADER}\n0,f,0x0p+0,0x0p0,-0x0p0,0x1p2,0,0,0,0X1.0P+2,0,0x.8p1,0x10p-4,0x1p0,+0x1\n"
                           f"1,f,0,0,0,0x4,0,0,0,4,0,1,1,1,0x1.ffffffp-1\n",
            "other columns": f"sub,{HEADER},group,src,hit,note\na b,0,f,{HIT},nan,http://x,1,\n,1,f,{MISS},x,,0,0x\n",
            "columns of swept cases, all empty": f"{HEADER},dx,dy,dz\n0,f,{HIT},,,\n1,f,{MISS}, , ,\n",
        }
        for name, csv in forms.items():
            with self.subTest(form=name):
                self.write("cases.csv", csv)
                scalar = "double" if name == "hexadecimal" else "float"
                self.assertEqual(self.verdicts("cases.csv", "--scalar", scalar)[0], [("0", 1), ("1", 0)])

    def test_swept_and_other_cases(self):
        rows = [f"0,f,{MISS},,,", f"1,f,{MISS},0,0,-0.5", f"2,f,{MISS},0,0,-0.484375", f"3,f,{HIT},0,0,9", f"4,f,{MISS},0,0,0",
                f"5,f,{MISS},0,0,nan", f"6,f,{HIT},inf,0,0"]
        self.write("cases.csv", "\n".join([HEADER + ",dx,dy,dz", *rows]))
        for precision in PRECISIONS[1:]:
            self.assertEqual([hit for _, hit in self.verdicts("cases.csv", "--precision", precision)[0]], [0, 1, 0, 1, 0, 0, 0])

    def test_the_order_of_the_columns(self):
        names = HEADER.split(",")
        rows = [dict(zip(names, f"{case},f,{numbers}".split(","))) for case, numbers in ((7, HIT), (3, MISS), (5, HIT))]
        for order in (names, names[::-1], sorted(names), names[5:] + names[:5]):
            self.write("cases.csv", "\n".join([",".join(order), *(",".join(row[n] for n in order) for row in rows)]))
            self.assertEqual(self.verdicts("cases.csv")[0], [("7", 1), ("3", 0), ("5", 1)])

    def test_every_number_counts(self):
        right = dict(zip(NUMBERS, "1 2 3 1 2 3 1 2 3 1 2 3 0".split()))  # a point at the centre
        for wrong in (None, *NUMBERS):
            values = [right[n] if n != wrong else "7" if n != "R" else "-1" for n in NUMBERS]
            # a triangle that still has a corner at the centre touches it
            expected = int(wrong is None or wrong[0] in "abc")
            self.assertEqual(self.hits(f"{HEADER}\n0,f,{','.join(values)}\n"), [expected], wrong)
        for corner in range(3):  # away from the centre is away, and only there
            values = ["9", "9", "9"] * 3 + "1 2 3 0".split()
            values[3 * corner:3 * corner + 3] = "1", "2", "3"
            self.assertEqual(self.hits(f"{HEADER}\n0,f,{','.join(values)}\n"), [1])
        self.assertEqual(self.hits(f"{HEADER}\n0,f,9,9,9,9,9,9,9,9,9,1,2,3,0\n"), [0])

    def test_nan_and_infinities(self):
        plain = HIT.split(",")
        self.assertEqual(self.hits(f"{HEADER}\n0,f,{HIT}\n"), [1])
        for bad in ("nan", "NaN", "-nan", "inf", "-inf", "+INF", "infinity"):
            rows = [",".join(["0", "f", *plain[:i], bad, *plain[i + 1:]]) for i in range(12)]
            for scalar in ("float", "double"):
                self.assertEqual(self.hits("\n".join([HEADER, *rows]), "--scalar", scalar), [0] * 12, bad)
            radius = self.hits(f"{HEADER}\n0,f,{','.join(plain[:12])},{bad}\n")
            self.assertEqual(radius, [int(bad in ("inf", "+INF", "infinity"))], bad)

    def test_no_rows(self):
        for end in ("", "\n", "\r\n\r\n"):
            self.write("cases.csv", HEADER + ",hit" + end)
            found, printed = self.verdicts("cases.csv")
            self.assertEqual((found, self.read("out.csv")), ([], b"id,hit\n"))
            self.assertEqual(self.table(printed)["total"], {"rows": 0, "hits": 0, "differ": 0, "false_hits": 0, "misses": 0})

    def test_without_the_column_hit_nothing_is_compared(self):
        self.write("cases.csv", f"{HEADER}\n0,f,{HIT}\n1,g,{MISS}\n2,f,{MISS}\n")
        found, printed = self.verdicts("cases.csv")
        self.assertEqual(found, [("0", 1), ("1", 0), ("2", 0)])
        self.assertEqual(self.table(printed), {"f": {"rows": 2, "hits": 1}, "g": {"rows": 1, "hits": 0}, "total": {"rows": 3, "hits": 1}})
        self.assertNotIn("differ", printed)

    def test_wrong_expectations_are_counted_and_no_failure(self):
        self.write("cases.csv", f"hit,{HEADER}\n" + "".join(f"{hit},{i},{f},{numbers}\n" for i, (hit, f, numbers) in enumerate(
            [(0, "f", HIT), (0, "f", HIT), (1, "f", MISS), (1, "f", HIT), (1, "g", HIT), (0, "g", MISS), (0, "h", HIT)])))
        found, printed = self.verdicts("cases.csv")
        self.assertEqual([hit for _, hit in found], [1, 1, 0, 1, 1, 0, 1])
        self.assertEqual(self.table(printed), {
            "f": {"rows": 4, "hits": 3, "differ": 3, "false_hits": 2, "misses": 1},
            "g": {"rows": 2, "hits": 1, "differ": 0, "false_hits": 0, "misses": 0},
            "h": {"rows": 1, "hits": 1, "differ": 1, "false_hits": 1, "misses": 0},
            "total": {"rows": 7, "hits": 5, "differ": 4, "false_hits": 3, "misses": 1}})
        self.assertIn("\n4 of 7 verdicts differ from the column hit\n", printed)


def value_of(text):
    """The real number that a text stands for."""
    match = re.fullmatch(r"([+-]?)0x([0-9a-f]*)\.?([0-9a-f]*)(?:p([+-]?\d+))?", text)
    if not match:
        return Fraction(text)
    sign, whole, part, exponent = match.groups()
    value = int(whole + part, 16) * Fraction(2) ** (int(exponent or 0) - 4 * len(part))
    return -value if sign == "-" else value


def rounded(text, kind):
    """Correctly rounded to 'f'loat or 'd'ouble; the decimal form of a hexadecimal number is exact."""
    value, context = value_of(text), Context(prec=2000, Emin=-99999, Emax=99999)
    decimal = context.divide(Decimal(value.numerator), Decimal(value.denominator)) if "x" in text else text
    return nearest(format(decimal, "f") if "x" in text else text, kind)


class Rounding(VerdictTest):
    """Numbers reach the scalar type in one correct rounding: a point at the rounded number is touched with radius 0, and its
    neighbours are not."""

    numbers = [
        "1", "0", "-0", "0x1.8p1", "-2.5", "16777216", "0x1.fffffep127", "0x1p-149", "-0x1p-149", "0x1.fffffcp-127", "0x0.000002p-126",
        "1.000000059604644775390625",  # halfway between two floats: to even, down
        "1.0000000596046447753906250000000000000000000001",  # a hair above it: up; a double cannot tell
        "1.0000000596046447753906249999999999999999999999",
        "1.00000000000000000000000000000000000000001", "1.000000000000000000000000000",
        "0x1.000001p0", "0x1.000003p0", "0x1.00000100000000000000000001p0", "0x1.000000ffffffffffffffffffp0", "-0x1.00000100000001p+0",
        "0x1.00000000000008p0", "0x1.000000000000080000001p0", "0x1.00000000000018p0",
        "0.1", "16777217", "16777219", "3.14159265358979323846264338327950288", "123456789.123456789",
        "0x1p-150", "0x1.000000000000000000001p-150", "0x1.8p-149", "0x3p-150", "0x1.8p-148", "1e-46", "1e-400", "0x1p-2000",
        "7.0064923216240853546186479164495e-46", "7.0064923216240853546186479164496e-46", "0x1p-1074", "0x1.8p-1074", "4.9e-324",
        "1.17549435082228750797e-38", "0x1.ffffffp-127", "340282346638528859811704183484516925440", "0x1.fffffeffffffp127", "3.4028235677973366e38",
    ]

    def check(self, scalar, kind, integer):
        rows, expected, inexact, most = [], [], 0, 0
        for text in self.numbers:
            value = rounded(text, kind)
            bits = struct.unpack(integer, struct.pack(kind, abs(value)))[0]
            for near in range(max(bits - 1, 0), bits + 2):
                centre = struct.unpack(kind, struct.pack(integer, near))[0] * (-1 if text.startswith("-") else 1)
                if not math.isinf(centre):
                    rows.append(f"{len(rows)},f,{','.join([text] * 9)},{','.join([centre.hex()] * 3)},0")
                    expected.append(int(near == bits))
                    inexact += 9 * (Fraction(value) != value_of(text))
                    most = max(most, abs(Fraction(value) - value_of(text)))
        self.assertEqual(sum(expected), len(self.numbers))
        self.write("cases.csv", "\n".join([HEADER, *rows]) + "\n")
        done = self.run_program("verdict", "cases.csv", "--scalar", scalar, "--output", "out.csv")
        self.assertEqual(done.returncode, 0)
        for row, want, (_, got) in zip(rows, expected, self.written()):
            self.assertEqual(got, want, row)
        # said once
        said = re.fullmatch(f"verdict: cases.csv: {inexact} of {13 * len(rows)} numbers had to be rounded to {scalar}, by at most (.*), "
                            "more than a thousandth of a radius; the verdicts are those of the rounded numbers\n", done.stderr.decode())
        self.assertTrue(said, done.stderr)
        six_digits = 1 + Fraction(1, 10**5)
        self.assertGreaterEqual(Fraction(said[1]) * six_digits, most)
        bound = most if scalar == "float" else max(abs(value_of(text)) for text in self.numbers) / 2**53
        self.assertLessEqual(Fraction(said[1]), bound * six_digits)

    def test_to_float(self):
        self.check("float", "f", "i")

    def test_to_double(self):
        self.check("double", "d", "q")

    def test_the_radius(self):
        # A point at distance 1: the radius rounds to 1 or to just below.
        for radius, scalar, hit in (("0.99999998", "float", 1), ("0.99999996", "float", 0), ("0.99999998", "double", 0), ("0x1.ffffffp-1", "float", 1),
                                    ("0x1.fffffe8p-1", "float", 0), ("0x1.ffffffp-1", "double", 0)):
            self.write("cases.csv", f"{HEADER}\n0,f,0,0,0,0,0,0,0,0,0,1,0,0,{radius}\n")
            done = self.run_program("verdict", "cases.csv", "--scalar", scalar, "--output", "out.csv")
            self.assertEqual((done.returncode, self.written()), (0, [("0", hit)]), (radius, scalar))

    def test_what_needs_no_rounding_gives_no_note(self):
        self.write("cases.csv", f"{HEADER}\n0,f,nan,inf,-inf,0x1p-149,0.5,-0,0x1.fffffep127,1e10,3,16777216,1,1,1\n")
        found, printed = self.verdicts("cases.csv")
        self.assertEqual(found, [("0", 0)])
        self.assertTrue(printed.endswith(")\nnone of 13 numbers had to be rounded to float\n"), printed)
        self.write("cases.csv", f"{HEADER}\n0,f,0x1.000001p0,0,0,0,0,0,0,0,0,0,0,0,1\n")
        self.assertIn(b" 1 of 13 numbers ", self.run_program("verdict", "cases.csv").stderr)
        self.assertEqual(self.run_program("verdict", "cases.csv", "--scalar", "double").stderr, b"")


class Scalar(VerdictTest):
    """Which scalar type is taken where nobody says it."""

    near = "16777217"  # is moved by 1 if it is a float

    def scalar(self, *numbers, more="", options=()):
        """The type that is taken for a case with these numbers."""
        self.write("cases.csv", f"{HEADER}{',dx,dy,dz' if more else ''}\n0,f,{','.join(map(str, numbers))}{more}\n")
        done = self.run_program("verdict", "cases.csv", *options)
        self.assertEqual(done.returncode, 0, done)
        return re.search(r" precision, (\w+) coordinates", done.stdout.decode())[1]

    def test_a_thousandth_of_the_radius_decides(self):
        for i in range(12):
            for radius, scalar in ((1001, "float"), (999, "double"), (-999, "double"), (0, "double"), ("inf", "float"), ("nan", "float")):
                numbers = [0] * 12 + [radius]
                numbers[i] = self.near
                self.assertEqual(self.scalar(*numbers), scalar, numbers)
        self.assertEqual(self.scalar(*[0] * 12, self.near), "float")
        for radius, scalar in ((1001, "float"), (999, "double")):
            self.assertEqual(self.scalar(*[0] * 12, radius, more=f",0,{self.near},0"), scalar)
        self.assertEqual(self.scalar(*[0] * 12, 0), "float")

    def test_each_case_has_its_own_radius(self):
        zeros = ",".join(["0"] * 11)
        self.write("cases.csv", f"{HEADER}\n0,f,{self.near},{zeros},1001\n1,f,0,{zeros},0\n")
        self.assertIn(b" float coordinates", self.run_program("verdict", "cases.csv").stdout)

    def test_the_options_decide(self):
        numbers = [self.near] + [0] * 11
        for precision in PRECISIONS:
            double = "double" if precision == "double" else "float"
            self.assertEqual(self.scalar(*numbers, 1001, options=("--precision", precision)), double)
            self.assertEqual(self.scalar(*numbers, 999, options=("--precision", precision)), "double")
            for scalar in ("float", "double"):
                self.assertEqual(self.scalar(*numbers, 999, options=("--precision", precision, "--scalar", scalar)), scalar)

    def test_the_verdict_is_that_of_the_text(self):
        # 2^24 + 1 is at distance 1 from the point, and 2^24 at distance 0
        row = f"0,f,{self.near},0,0,{self.near},0,0,{self.near},0,0,16777216,0,0,0.5"
        self.write("cases.csv", f"{HEADER},hit\n{row},0\n")
        for options, hit in (((), 0), (("--precision", "double"), 0), (("--scalar", "float"), 1), (("--scalar", "float", "--precision", "double"), 1)):
            done = self.run_program("verdict", "cases.csv", "--output", "out.csv", *options)
            self.assertEqual((done.returncode, self.written()), (0, [("0", hit)]), options)
            said = f"verdict: cases.csv: 3 of 13 numbers had to be rounded to float, by at most 1, more than a thousandth of a radius; " \
                   "the verdicts are those of the rounded numbers\n"
            self.assertEqual(done.stderr.decode(), said if hit else "")
            if not options:
                self.assertTrue(done.stdout.endswith(b"none of 13 numbers had to be rounded to double; float would move one by 1\n"), done.stdout)


class BadCases(VerdictTest):
    def refused(self, csv, words, *args):
        """The file is refused, before anything is written."""
        self.write("cases.csv", csv)
        self.write("out.csv", "old")
        self.fail_with(1, words, "verdict", "cases.csv", "--output", "new.csv", *args)
        message = self.fail_with(1, words, "verdict", "cases.csv", "--output", "out.csv", *args)
        self.assertEqual(self.read("out.csv"), b"old")
        return message

    def test_bad_numbers_are_named(self):
        good = HIT.split(",")
        for bad in ("x", "1x", "0x", "0x1p", "1e", "--1", "+-1", "- 1", "1 2", "1.2.3", "0xg", "nanx", "in", "1_000", "\v1", "1\0", "1e39", "-1e39",
                    "0x1p128", "0x1.ffffffp127", "3.4028235677973367e38", "1e309", "1e999", "1e99999999999999999999", ""):
            for i in (0, 7, 12):
                row = ",".join(["3", "f", *good[:i], bad, *good[i + 1:]])
                with self.subTest(bad=bad, column=NUMBERS[i]):
                    words = ["cases.csv:4: ", f"'{NUMBERS[i]}'"] + (["nothing"] if not bad else [f"'{bad}'"] if bad.isprintable() else ["not a number"])
                    csv = f"{HEADER}\n0,f,{HIT}\n\n{row}\n0,f,{HIT}\n"
                    self.refused(csv, words, "--scalar", "float")
                    if not bad.endswith(("39", "128", "127", "38")):  # which are numbers as doubles
                        self.refused(csv, words)
                        self.refused(csv, words, "--scalar", "double")

    def test_a_number_that_is_too_large_for_float_only(self):
        for number in ("340282366920938463463374607431768211456", "0x1p128", "0x1.ffffffp127"):
            csv = f"{HEADER}\n0,f,{number},0,0,0,0,0,0,0,0,0,0,0,1\n"
            self.refused(csv, ["cases.csv:2: ", number, "'ax'", "largest"], "--scalar", "float")
            self.assertIn("; float cannot hold one\n", self.succeed("verdict", "cases.csv"))
            self.assertEqual(self.hits(csv, "--scalar", "double"), [1])
        self.refused(f"{HEADER}\n0,f,1e309,0,0,0,0,0,0,0,0,0,0,0,1\n", ["cases.csv:2: ", "1e309", "'ax'"], "--scalar", "double")

    def test_missing_and_double_columns(self):
        names = HEADER.split(",")
        for missing in names:
            rest = [n for n in names if n != missing]
            self.refused(",".join(rest) + "\n" + ",".join("1" for _ in rest) + "\n", ["cases.csv:1: ", f"'{missing}'"])
        for twice in [*names, "hit", "dx"]:
            self.refused(f"{HEADER},hit,dx,{twice}\n", ["cases.csv:1: ", "two", f"'{twice}'"])
        for header in ("1,2,3", HEADER.replace("R", "r"), HEADER.upper(), HEADER.replace(",", ";"), '"' + HEADER):
            self.refused(header + "\n", ["cases.csv:1: "])

    def test_swept_cases(self):
        for fields in ("1,,", ",0,", ",,nan", "0x1p0,0,", ",0,0"):
            for header, row in ((HEADER + ",dx,dy,dz", f"9,f,{HIT},{fields}"), ("dz,dy,dx," + HEADER, f"{fields},9,f,{HIT}")):
                empty = f"0,f,{HIT},,," if header.startswith("id") else f",,,0,f,{HIT}"
                self.refused(f"{header}\n{empty}\n{row}\n{empty}\n", ["cases.csv:3: ", "swept", "dx"])
        self.refused(f"{HEADER},dx,dy,dz\n0,f,{HIT},0,x,0\n", ["cases.csv:2: ", "'x'", "'dy'"])
        message = self.fail_with(1, ["swept", "baseline"], "verdict", DATA / "swept_f32.csv", "--precision", "baseline", "--output", "new.csv")
        self.assertIn(str(DATA), message)

    def test_bad_rows(self):
        for header, row, words in ((HEADER, "1,f,0,0,0", ["fewer"]), (HEADER, f"1,f,{HIT},1", ["more"]), (HEADER, f",f,{HIT}", ["'id'", "nothing"]),
                                   (HEADER, f'"1,2",f,{HIT}', ["'id'"]), (HEADER, f'"1""2",f,{HIT}', ["'id'"]), (HEADER, f'"1,f,{HIT}', ["quotation"]),
                                   (HEADER + ",hit", f"1,f,{HIT},2", ["'2'", "'hit'"]), (HEADER + ",hit", f"1,f,{HIT},", ["'hit'"]),
                                   (HEADER + ",hit", f"1,f,{HIT},yes", ["'yes'", "'hit'"]), (HEADER + ",hit", f"1,f,{HIT},01", ["'01'", "'hit'"])):
            with self.subTest(row=row):
                self.refused(f"{header}\n{row}\n", ["cases.csv:2: ", *words])

    def test_no_cases(self):
        self.write("empty.csv", "")
        self.write("blank.csv", "\n \n")
        for name in ("missing.csv", "empty.csv", "blank.csv", ".", "no/such/folder.csv"):
            self.fail_with(1, [name + ":"], "verdict", name, "--output", "new.csv")


class Usage(VerdictTest):
    def setUp(self):
        super().setUp()
        self.csv = f"{HEADER},hit\n0,f,{HIT},1\n1,f,{MISS},0\n"
        self.write("cases.csv", self.csv)

    def test_bad_usage(self):
        for words, args in ((["cases"], []), (["--nonsense"], ["cases.csv", "--nonsense"]), (["third"], ["cases.csv", "second", "third"]),
                            (["--precision"], ["cases.csv", "--precision", "half"]), (["--precision"], ["cases.csv", "--precision"]),
                            (["--scalar"], ["cases.csv", "--scalar", "int"]), (["--space"], ["cases.csv", "--space", "moon"]),
                            (["--output", "cases.csv"], ["cases.csv", "--output", "./cases.csv"]), (["--output"], ["cases.csv", "--output"])):
            with self.subTest(args=args):
                self.fail_with(2, words, "verdict", *args)
        self.assertEqual(self.read("cases.csv").decode(), self.csv)

    def test_help_and_version(self):
        text = self.succeed("verdict", "--help")
        for option in ("--precision", "baseline", "single", "double", "exact", "--scalar", "float", "--space", "host", "cuda_shared", "--output"):
            self.assertIn(option, text)
        self.assertRegex(self.succeed("verdict", "--version"), r"^verdict .*\d+\.\d+\.\d+\n$")

    def test_cuda_that_is_not_there(self):
        for space in ("cuda", "cuda_shared"):
            if self.run_program("verdict", "cases.csv", "--space", space).returncode == 0:
                self.skipTest("there is a CUDA device")
            self.fail_with(1, ["--space", "CUDA"], "verdict", "cases.csv", "--output", "new.csv", "--space", space)

    def test_without_output_there_is_the_table(self):
        printed = self.succeed("verdict", "cases.csv")
        self.assertEqual(self.table(printed)["total"]["rows"], 2)
        self.assertEqual(self.files(), ["cases.csv"])

    def test_places_that_cannot_be_written(self):
        os.mkdir(self.path("folder"))
        for path in ("no/such/folder/x.csv", "folder", "cases.csv/x.csv", "/dev/full"):
            self.fail_with(1, [path], "verdict", "cases.csv", "--output", path)

    def test_the_output_replaces_a_file_and_leaves_no_other(self):
        self.write("target.csv", "old")
        os.chmod(self.path("target.csv"), 0o640)
        os.symlink("target.csv", self.path("out.csv"))
        self.assertEqual(self.verdicts("cases.csv")[0], [("0", 1), ("1", 0)])
        self.assertEqual(stat.S_IMODE(os.stat(self.path("target.csv")).st_mode), 0o640)
        self.assertEqual(self.files(), ["cases.csv", "out.csv", "target.csv"])

    def test_pipes(self):
        done = subprocess.run([programs.PROGRAMS / "verdict", "/dev/stdin", "--output", "/dev/stdout"], input=self.csv.encode(), capture_output=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, b"id,hit\n0,1\n1,0\n", b""))  # and no table


if __name__ == "__main__":
    programs.main()

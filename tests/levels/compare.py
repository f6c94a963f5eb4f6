"""Compares two programs that print `NAME SECONDS HASH` for each scene: results have the same bits, and the first program
takes no longer than the second, except for a part.

Usage: compare.py PROGRAM REFERENCE LIMIT

The two run in turn, twice at least and up to ten times while the least time of a scene is above the limit: other
programs on the machine make times longer, never shorter.
"""
import subprocess
import sys


def run(program, times, hashes):
    """Keeps the least time of each scene so far."""
    for line in subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines():
        name, seconds, number = line.split()
        times[name] = min(times.get(name, float("inf")), float(seconds))
        if hashes.setdefault(name, number) != number:
            sys.exit(f"{name}: {program} has other results")


def main():
    program, reference, limit = sys.argv[1], sys.argv[2], float(sys.argv[3])
    times, least, hashes = {}, {}, {}
    for turn in range(10):
        run(program, times, hashes)
        run(reference, least, hashes)
        ratios = {name: times[name] / least[name] for name in least}
        if turn > 0 and max(ratios.values()) <= limit:
            break
    for name, ratio in ratios.items():
        print(f"{name:30} {1e3 * times[name]:9.3f} ms {ratio:6.2f}")
    slow = [name for name, ratio in ratios.items() if ratio > limit]
    if slow or not ratios:
        sys.exit(f"more than {limit} of the time: {', '.join(slow)}")


main()

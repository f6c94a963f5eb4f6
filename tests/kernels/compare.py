"""Compiles steps.cu and compares the kernels of simulations with those written by hand for the same effects: registers
(as ptxas reports them) and instructions (16 bytes each, by the size of the kernel's section). Needs no GPU.

    compare.py NVCC SOURCE FLAG...
"""
import os
import re
import struct
import subprocess
import sys
import tempfile

# a step may have this much more than a kernel written by hand
MORE_REGISTERS = 24  # all loads are issued first, which takes registers and saves time
MORE_INSTRUCTIONS = 1.12

PAIRS = {
    "by_hand_none": r"step_kernel.*effect_listIfJEE",
    "by_hand_gravity": r"step_kernel.*effect_listIfJNS_7gravityEEE",
    "by_hand_gravity_drag": r"step_kernel.*effect_listIfJNS_7gravityENS_4dragEEE",
}


def sections(path):
    """Names and sizes of the sections of a 64-bit ELF file."""
    with open(path, "rb") as file:
        data = file.read()
    offset, = struct.unpack_from("<Q", data, 0x28)
    size, count, names = struct.unpack_from("<HHH", data, 0x3A)
    headers = [struct.unpack_from("<IIQQQQ", data, offset + i * size) for i in range(count)]
    table = headers[names][4]
    return {data[table + h[0]:data.index(b"\0", table + h[0])].decode(): h[5] for h in headers}


def main(nvcc, source, flags):
    with tempfile.TemporaryDirectory() as folder:
        cubin = os.path.join(folder, "steps.cubin")
        log = subprocess.run([nvcc, *flags, "-cubin", "-Xptxas", "-v", "-o", cubin, source],
                             check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True).stdout
        code = {name[len(".text."):]: size // 16 for name, size in sections(cubin).items() if name.startswith(".text.")}
    registers, kernel = {}, None
    for line in log.splitlines():
        if found := re.search(r"Compiling entry function '(\S+)'", line):
            kernel = found[1]
        elif found := re.search(r"Used (\d+) registers", line):
            registers[kernel] = int(found[1])

    def only(pattern):
        names = [name for name in registers if re.search(pattern, name)]
        assert len(names) == 1, f"{pattern}: {names}"
        return registers[names[0]], code[names[0]]

    right = True
    for by_hand, step in PAIRS.items():
        expected, measured = only(by_hand + "[A-Z]"), only(step)
        fits = (measured[0] <= expected[0] + MORE_REGISTERS and measured[1] <= expected[1] * MORE_INSTRUCTIONS)
        right = right and fits
        print(f"{by_hand}: {expected[0]} registers, {expected[1]} instructions; "
              f"step: {measured[0]} registers, {measured[1]} instructions{'' if fits else '  TOO MANY'}")
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]))

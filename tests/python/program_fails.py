#!/usr/bin/python3
"""A program for -program that fails: program_fails.py HOW PIDS. It adds its process id to the file PIDS."""
import json
import os
import struct
import sys
import time

HOW, PIDS = sys.argv[1:3]
STATE = struct.pack("<4d", 0.5, 0, 1.5, 0)


def main():
    with open(PIDS, "a", encoding="utf-8") as file:
        file.write(f"{os.getpid()}\n")
    print("a last word on standard error", file=sys.stderr)
    read, write = sys.stdin.buffer, sys.stdout.buffer
    described = {"protocol": 2 if HOW == "protocol" else 1, "name": "fails", "dim": 1, "cell_width": 1.0,
                 "particles": 2, "fields": [{"name": "x", "size": 1, "place": True}, {"name": "v", "size": 1}],
                 "parameters": {"dt": 1.0}}
    if HOW == "prints":
        write.write(b"hello, here is your code\n")
    for line in read:
        ask = json.loads(line)
        if ask["do"] == "describe":
            write.write(json.dumps(described).encode() + b"\n" + STATE)
        elif ask["do"] == "set":
            write.write(b'{"error": "dt is too large"}\n')
        elif HOW == "dies":
            sys.exit(5)
        elif HOW == "hangs":
            time.sleep(3600)
        elif HOW == "short":
            read.read(32)
            write.write(b"{}\n" + STATE[:24])
            write.flush()
            sys.exit(0)
        elif HOW == "nan":
            read.read(32)
            write.write(b"{}\n" + struct.pack("<4d", 0.5, 0, 1.5, float("nan")))
        elif HOW == "more":
            read.read(32)
            write.write(b"{}\n" + STATE + STATE)
        elif HOW == "error":
            read.read(32)
            write.write(b'{"error": "particle 1 has left"}\n')
        else:
            break
        write.flush()


main()

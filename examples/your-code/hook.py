"""The hook in Python: hook.py [amplitude [no]]. It writes A.mtx before the first step and prints the state after 50 steps."""
import sys

from bar import H, advance, start
from mpmstab.adapter import probe

state = start(float(sys.argv[1]) if len(sys.argv) > 1 else 0)
if len(sys.argv) < 3:  # a second word leaves the hook out
    while probe("A.mtx", H, state, periodic=[1.0], scale={"v": 1, "stress": 1}):
        advance(state)
for _ in range(50):
    advance(state)
for numbers in zip(*state.values()):
    print(*(float(number).hex() for number in numbers))

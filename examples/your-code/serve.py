"""The bar as a program: mpmstab spectrum -program 'python3 serve.py'"""
from bar import DT, H, advance, start
from mpmstab.adapter import serve

serve(advance, start(0), cell_width=H, periodic=[1.0], parameters={"dt": DT}, name="bar",
      fields={"x": {"place": True}, "v": {"scale": 1}, "stress": {"scale": 1}})

% The hook in Octave: hook.m [amplitude [no]]. It writes A.mtx before the first step and prints the state after 50 steps.
words = argv();
amplitude = 0;
if numel(words) > 0, amplitude = str2double(words{1}); end
h = 1 / 16;
dt = h / 2;
x = ((0:31).' + 0.5) * h / 2;
v = amplitude * sin(2 * pi * x);
stress = zeros(32, 1);
busy = numel(words) < 2; % a second word leaves the hook out
while busy
  [x, v, stress, busy] = mpmstab_probe('A.mtx', [h 1], x, v, stress);
  if busy, [x, v, stress] = advance(x, v, stress, h, dt); end
end
for n = 1:50, [x, v, stress] = advance(x, v, stress, h, dt); end
for i = 1:32, printf('%s %s %s\n', num2hex(x(i)), num2hex(v(i)), num2hex(stress(i))); end

% The bar of program_steps.py with musl, in Octave: octave -q program_musl.m FOLDER, where mpmstab_serve.m is.
addpath(argv(){1});

function after = musl_step(s, p)
% h = c = rho = 1; hats, flip, periodic; stress after the velocity of the particles is mapped once more.
  n = 16;
  at = floor(s.x);
  xi = s.x - at;
  left = mod(at, n) + 1;
  right = mod(at + 1, n) + 1;
  sum_of = @(a, b) accumarray([left; right], [a; b], [n, 1]);
  read = @(nodes) (1 - xi) .* nodes(left) + xi .* nodes(right);
  mass = sum_of(1 - xi, xi);
  a = sum_of(s.s, -s.s) ./ mass;
  after.v = s.v + p.dt * read(a);
  nodes = sum_of((1 - xi) .* after.v, xi .* after.v) ./ mass;
  after.s = s.s + p.dt * (nodes(right) - nodes(left));
  after.x = mod(s.x + p.dt * read(nodes), n);
end

x = ((0:31).' + 0.5) / 2;
mpmstab_serve(@musl_step, struct('x', x, 'v', 0 * x, 's', 0 * x), ...
              struct('cell_width', 1, 'periodic', 16, 'parameters', struct('dt', 0.5), 'name', 'musl'));

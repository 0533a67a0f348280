% The bar as a program: mpmstab spectrum -program 'octave -q serve.m'
h = 1 / 16;
function state = bar(state, h, dt)
  [state.x, state.v, state.stress] = advance(state.x, state.v, state.stress, h, dt);
end
state = struct('x', ((0:31).' + 0.5) * h / 2, 'v', zeros(32, 1), 'stress', zeros(32, 1));
about = struct('cell_width', h, 'periodic', 1, 'parameters', struct('dt', h / 2), 'name', 'bar', ...
               'scale', struct('v', 1, 'stress', 1));
mpmstab_serve(@(state, parameters) bar(state, h, parameters.dt), state, about);

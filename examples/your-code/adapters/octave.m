% An adapter for your code. Fill in the five places, then: mpmstab spectrum -program 'octave -q mine.m'; of MATLAB 'matlab -batch mine'.
% It calls mpmstab_serve: mpmstab adapter mpmstab_serve.m > mpmstab_serve.m
1; % in Octave this file is a script

% FILL 1: the state: all that a step changes and a later step reads. The first index is the particle.
state = struct('x', zeros(8, 2), 'v', zeros(8, 2), 'stress', zeros(8, 3));

% FILL 2: the width of a cell, and the period of each direction (NaN: it has no period).
about = struct('cell_width', 0.1, 'periodic', [NaN, NaN], 'name', 'mine');

% FILL 3: the parameters that mpmstab may set, with the values of your code.
about.parameters = struct('dt', 1e-4);

% FILL 4: the field that is the place. Where you know it, the size of a usual change of another field: struct('v', 20).
[about.place, about.scale] = deal('x', struct());

% FILL 5: one step. It returns the state after it, and keeps nothing else.
step = @(state, parameters) error('FILL 5: one step of your code');

mpmstab_serve(step, state, about);

% An adapter for your code. Fill in the five places, then: mpmstab spectrum -program 'octave -q mine.m'; of MATLAB 'matlab -batch mine'.
% mpmstab chooses the particles: 10 cells each way with 2 particles each way, or those of -program_scene.
% It calls mpmstab_serve: mpmstab adapter mpmstab_serve.m > mpmstab_serve.m
1; % in Octave this file is a script

% FILL 1: one particle at rest: the names and values of all that a step changes and a later step reads, and what else differs
% from particle to particle. The first index is the particle.
state = struct('x', zeros(1, 2), 'v', zeros(1, 2), 'stress', zeros(1, 3), 'volume', 1, 'mass', 1);

% FILL 2: the width of a cell. The grid has the periods that mpmstab asks for, or yours: about.periodic = [1, NaN].
about = struct('cell_width', 0.1, 'scenes', true, 'name', 'mine');

% FILL 3: the parameters that mpmstab may set, with the values of your code.
about.parameters = struct('dt', 1e-4);

% FILL 4: which of the names above is the place, and which are the volume and the mass ('' where they are not there).
[about.place, about.volume, about.mass] = deal('x', 'volume', 'mass');

% FILL 5: one step. It returns the state after it, and keeps nothing else. parameters.grid.periodic has the period of each direction, or NaN.
step = @(state, parameters) error('FILL 5: one step of your code');

mpmstab_serve(step, state, about);

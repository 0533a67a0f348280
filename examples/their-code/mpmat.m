% The bar of mpmat as a program for mpmstab:
%
%   mpmstab symbol -program 'octave-cli -q mpmat.m FOLDER [NAME=VALUE ...]'
%
% FOLDER is a clone of https://github.com/vinhphunguyen/mpmat. The text of its example1D/mpm1DVibrationBar.m is read and
% run as it is: once what comes before the time loop, and for each step the body of the loop. Left out are lines that
% clear the workspace or draw. NAME=VALUE replaces what the script assigns to NAME, such as ppc=1. Words of ours: middle
% (so many cells in the middle of the grid have particles, and no others), shift (of all particles, in cells), drift
% (cells that a particle moves per step), period (steps after which the state is compared).
1; % a file of functions and commands

function state = advance(state, dt)
% A step of the script. It works on the variables of the session, as a script does.
for name = fieldnames(state).', assignin('base', name{1}, state.(name{1})); end
assignin('base', 'dtime', dt);
evalin('base', 'eval(before_body); eval(body);');
for name = fieldnames(state).', state.(name{1}) = evalin('base', name{1}); end
end

words = argv();
ours = struct('middle', Inf, 'shift', 0, 'drift', 0, 'period', 1);
addpath(fullfile(fileparts(mfilename('fullpath')), '..', 'your-code'));
cd(fullfile(words{1}, 'example1D'));
text = fileread('mpm1DVibrationBar.m');
for k = 2:numel(words)
  [name, value] = strtok(words{k}, '=');
  if isfield(ours, name)
    ours.(name) = eval(value(2:end));
  else
    [first, last] = regexp(text, ['^\s*' name '\s*=[^;]*;'], 'once', 'lineanchors');
    if isempty(first), error('mpmat.m: the script assigns nothing to %s', name); end
    text = [text(1:first - 1), words{k}, ';', text(last + 1:end)];
  end
end
text = regexprep(text, '^\s*(clc|clear|hold|plot|axis)\>.*$', '', 'lineanchors', 'dotexceptnewline');
parts = regexp(text, '^(.*?)^while[^\n]*\n(.*?)^end', 'tokens', 'once', 'lineanchors');
body = parts{2};
warning('off', 'all'); % of folders that are not there
eval(parts{1});

% Its list of the particles in each element has to be of the state that is given, and so have the arrays that stay.
before_body = ['mpoints = arrayfun(@(e) find(floor(xp / deltax) + 1 == e), 1:elemCount, "UniformOutput", false);' ...
               '[Mp, Vp0, eps] = deal(0 * xp + Mp(1), 0 * xp + Vp0(1), 0 * xp);'];
here = abs(xp - deltax * elemCount / 2) < ours.middle * deltax / 2;
xp = xp + ours.shift * deltax;
vp = 0 * xp + ours.drift * deltax / dtime;
state = struct('xp', xp(here), 'vp', vp(here), 's', s(here), 'Fp', Fp(here), 'Vp', Vp(here));
about = struct('name', 'mpm1DVibrationBar', 'cell_width', deltax, 'place', 'xp', 'parameters', struct('dt', dtime), ...
               'scale', struct('vp', c, 's', E), 'steps', ours.period, 'any_count', true);
mpmstab_serve(@(state, parameters) advance(state, parameters.dt), state, about);

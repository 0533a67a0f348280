function [x, v, stress] = advance(x, v, stress, h, dt)
% A bar with a period of length 1: a step of MPM as it is in many codes (update stress last, hat functions). Density and
% stiffness are 1.
cells = round(1 / h);
volume = h / 2;
s = x / h - floor(x / h);
left = mod(floor(x / h), cells) + 1;
right = mod(left, cells) + 1;
nodes = @(a, b) accumarray([left; right], [a; b], [cells, 1]);
mass = nodes((1 - s) * volume, s * volume);
force = nodes(volume * stress / h, -volume * stress / h);
velocity = (nodes((1 - s) * volume .* v, s * volume .* v) + dt * force) ./ mass;
acceleration = force ./ mass;
v = v + dt * ((1 - s) .* acceleration(left) + s .* acceleration(right));
stress = stress + dt * (velocity(right) - velocity(left)) / h;
x = x + dt * ((1 - s) .* velocity(left) + s .* velocity(right));
x = x - floor(x);
end

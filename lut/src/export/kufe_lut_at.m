function [value, out_of_range] = kufe_lut_at(t, quantity, fz_n, curvature_1pm, varargin)
% A quantity of a lookup table of kufe at one contact, bilinear: for MATLAB and Octave.
%
%   t = load('front.mat');
%   [p, outside] = kufe_lut_at(t, 'p_max_pa', 1800, 0.02);
%   [mu, outside] = kufe_lut_at(t, 'mu', 1800, 0.02, 'v_mps', 30, 'ice_c', -5);
%
% Further axes are given by name: 'v_mps', 'ice_c', 'rocker_radius_m'. Inputs outside become what t.outside says of their
% axis: 'hold', 'linear' or 'error' (NaN). The arithmetic is that of kufe's bilinear mode.
  % A runner that has lifted off has no smaller pressure than at a force of 0.
  if fz_n < 0
    fz_n = 0;
  end
  given = struct('fz_n', fz_n, 'curvature_1pm', curvature_1pm, varargin{:});
  names = {'fz_n', 'curvature_1pm', 'rocker_radius_m', 'v_mps', 'ice_c'};
  if isfield(t, 'flush')
    names{2} = 'reduced_curvature';
    given.reduced_curvature = reduced(t.flush, min(max(fz_n, t.fz_n(1)), t.fz_n(end)), curvature_1pm);
  end
  names = names(isfield(t, names));
  places = cell(size(names));
  out_of_range = false;
  refused = false;
  for k = 1:numel(names)
    rule = t.outside.(names{k});
    places{k} = place(t.(names{k}), given.(names{k}), rule);
    out_of_range = out_of_range || places{k}.outside;
    refused = refused || (places{k}.outside && strcmp(rule, 'error')) || isnan(given.(names{k}));
  end
  if refused
    value = NaN;
    out_of_range = true;
    return
  end
  sizes = cellfun(@(name) numel(t.(name)), names);
  values = reshape(t.(quantity), [sizes, 1]);
  rocker = find(strcmp(names, 'rocker_radius_m'));
  if ~isempty(rocker)
    % The third axis.
    p = places{rocker};
    low = values(:, :, p.low, :, :);
    values = low + (values(:, :, p.high, :, :) - low) * p.part;
    places(rocker) = [];
    sizes(rocker) = [];
    values = reshape(values, [sizes, 1]);
  end
  [x, y] = places{1:2};
  columns = reshape(values, sizes(1), sizes(2), []);
  left = columns(x.low, y.low, :) + (columns(x.high, y.low, :) - columns(x.low, y.low, :)) * x.part;
  right = columns(x.low, y.high, :) + (columns(x.high, y.high, :) - columns(x.low, y.high, :)) * x.part;
  layers = reshape(left + (right - left) * y.part, [sizes(3:end), 1, 1]);
  value = along(layers, places(3:end));
end

% The weighted sum of layers along the axes that are left, the first one outermost.
function value = along(layers, places)
  if isempty(places)
    value = layers;
    return
  end
  p = places{1};
  at = [p.low, p.high];
  weights = [1 - p.part, p.part];
  if p.low == p.high
    weights = [1, 0];
  end
  value = 0;
  for k = find(weights ~= 0)
    value = value + weights(k) * along(reshape(layers(at(k), :), [], 1), places(2:end));
  end
end

% Where an input lies on an axis.
function p = place(axis, x, rule)
  last = numel(axis);
  p.outside = x < axis(1) || x > axis(last);
  straight = p.outside && strcmp(rule, 'linear');
  if ~straight
    x = min(max(x, axis(1)), axis(last));
  end
  p.low = max(1, find([true, axis(2:end) <= x], 1, 'last'));
  p.high = min(p.low + 1, last);
  if straight && x > axis(last)
    p.low = max(1, last - 1);
    p.high = last;
  end
  p.part = 0;
  if p.low ~= p.high
    p.part = (x - axis(p.low)) / (axis(p.high) - axis(p.low));
  end
end

% The reduced curvature of a force and a curvature.
function place = reduced(flush, fz, curvature)
  far = @(x) abs(x) + sqrt(1 + x * x);
  width = flush(2) * fz;
  below = far((flush(3) - flush(1)) / width);
  whole = log(far((flush(4) - flush(1)) / width) * below);
  x = (curvature - flush(1)) / width;
  if x < 0
    place = log(below / far(x)) / whole;
  else
    place = log(far(x) * below) / whole;
  end
end

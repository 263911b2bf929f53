% A frame that Python saved as .nc, in Octave (package netcdf) or MATLAB: octave-cli frame.m FRAME.nc
% Arrays come with the dimensions turned round: [range, azimuth].
if exist ("OCTAVE_VERSION", "builtin")
  pkg load netcdf
end
words = argv ();
file = words{1};

iq = complex (double (ncread (file, "i")), double (ncread (file, "q")));
azimuth = ncread (file, "bearing");      % degrees from true north
range = ncread (file, "range");          % metres, slant
latitude = ncread (file, "latitude");
bearing = ncreadatt (file, "/", "pose_bearing_deg");

[strongest, where] = max (abs (iq(:)));
[k, i] = ind2sub (size (iq), where);
printf ("bins %d %d\n", columns (iq), rows (iq));
printf ("bearing %.17g\n", bearing);
printf ("strongest %.9g %.9g at range %.17g azimuth %.17g latitude %.17g\n", ...
        real (iq(k, i)), imag (iq(k, i)), range(k), azimuth(i), latitude(k, i));

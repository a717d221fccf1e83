-- A store of version 7: that of v6.sql, with digests of its plan.
-- Frozen: a store of this version must be read for ever.
PRAGMA application_id = 1413763924; PRAGMA user_version = 7;
PRAGMA foreign_keys=OFF;
BEGIN TRANSACTION;
CREATE TABLE bodies (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  recorded_at_utc TEXT NOT NULL CHECK (recorded_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  shape TEXT NOT NULL CHECK (shape = 'sphere' OR shape = 'rectangle' OR shape = 'other' OR shape = 'not applicable' OR shape = 'not recorded'),
  material TEXT NOT NULL CHECK (material = 'steel' OR material = 'aluminium' OR material = 'glass' OR material = 'rubber' OR material = 'plastic' OR material = 'wood' OR material = 'stone' OR material = 'concrete' OR material = 'other' OR material = 'not applicable' OR material = 'not recorded'),
  diameter_m ANY, diameter_m_u ANY, diameter_m_low ANY, diameter_m_high ANY, diameter_m_absent TEXT,
  long_m ANY, long_m_u ANY, long_m_low ANY, long_m_high ANY, long_m_absent TEXT,
  short_m ANY, short_m_u ANY, short_m_low ANY, short_m_high ANY, short_m_absent TEXT,
  mass_kg ANY, mass_kg_u ANY, mass_kg_low ANY, mass_kg_high ANY, mass_kg_absent TEXT,
  note TEXT NOT NULL,
  CHECK (CASE WHEN diameter_m IS NULL THEN diameter_m_absent IS NOT NULL AND coalesce(diameter_m_u, diameter_m_low, diameter_m_high) IS NULL ELSE diameter_m_absent IS NULL AND typeof(diameter_m) = 'real' AND typeof(diameter_m_u) = 'real' AND diameter_m_u >= 0 AND typeof(diameter_m_low) IN ('real', 'null') AND typeof(diameter_m_high) = typeof(diameter_m_low) AND coalesce(diameter_m_low <= diameter_m_high, 1) END),
  CHECK (CASE WHEN long_m IS NULL THEN long_m_absent IS NOT NULL AND coalesce(long_m_u, long_m_low, long_m_high) IS NULL ELSE long_m_absent IS NULL AND typeof(long_m) = 'real' AND typeof(long_m_u) = 'real' AND long_m_u >= 0 AND typeof(long_m_low) IN ('real', 'null') AND typeof(long_m_high) = typeof(long_m_low) AND coalesce(long_m_low <= long_m_high, 1) END),
  CHECK (CASE WHEN short_m IS NULL THEN short_m_absent IS NOT NULL AND coalesce(short_m_u, short_m_low, short_m_high) IS NULL ELSE short_m_absent IS NULL AND typeof(short_m) = 'real' AND typeof(short_m_u) = 'real' AND short_m_u >= 0 AND typeof(short_m_low) IN ('real', 'null') AND typeof(short_m_high) = typeof(short_m_low) AND coalesce(short_m_low <= short_m_high, 1) END),
  CHECK (CASE WHEN mass_kg IS NULL THEN mass_kg_absent IS NOT NULL AND coalesce(mass_kg_u, mass_kg_low, mass_kg_high) IS NULL ELSE mass_kg_absent IS NULL AND typeof(mass_kg) = 'real' AND typeof(mass_kg_u) = 'real' AND mass_kg_u >= 0 AND typeof(mass_kg_low) IN ('real', 'null') AND typeof(mass_kg_high) = typeof(mass_kg_low) AND coalesce(mass_kg_low <= mass_kg_high, 1) END)
) STRICT;
CREATE TABLE budget_lines (
  revision_id INTEGER NOT NULL,
  ordinal INTEGER NOT NULL,
  budget TEXT NOT NULL CHECK (budget = 'approach' OR budget = 'attitude'),
  line INTEGER NOT NULL CHECK (line >= 0),
  source TEXT NOT NULL,
  u_rad ANY NOT NULL CHECK (typeof(u_rad) = 'real'),
  PRIMARY KEY (revision_id, ordinal, budget, line),
  FOREIGN KEY (revision_id, ordinal)
    REFERENCES contacts (revision_id, ordinal)
) STRICT, WITHOUT ROWID;
CREATE TABLE calibrations (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  recorded_at_utc TEXT NOT NULL CHECK (recorded_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  camera_id INTEGER REFERENCES cameras (id),
  contents TEXT NOT NULL CHECK (contents = 'lens' OR contents = 'scale' OR contents = 'ground' OR contents = 'several' OR contents = 'other' OR contents = 'not applicable' OR contents = 'not recorded'),
  made_on TEXT NOT NULL,
  document TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  note TEXT NOT NULL
) STRICT;
CREATE TABLE cameras (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  recorded_at_utc TEXT NOT NULL CHECK (recorded_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  maker TEXT NOT NULL,
  model TEXT NOT NULL,
  serial TEXT NOT NULL,
  firmware TEXT NOT NULL,
  lens TEXT NOT NULL,
  note TEXT NOT NULL
) STRICT;
CREATE TABLE campaigns (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL UNIQUE CHECK (name <> ''),
  body_kind TEXT NOT NULL CHECK (body_kind IN ('sphere', 'rectangle')),
  diameter_m ANY, diameter_m_u ANY, diameter_m_low ANY, diameter_m_high ANY, diameter_m_absent TEXT,
  long_m ANY, long_m_u ANY, long_m_low ANY, long_m_high ANY, long_m_absent TEXT,
  short_m ANY, short_m_u ANY, short_m_low ANY, short_m_high ANY, short_m_absent TEXT,
  surface_id INTEGER REFERENCES surfaces (id),
  angle_kind TEXT NOT NULL CHECK (angle_kind = 'approach' OR angle_kind = 'radius' OR angle_kind = 'face'),
  bounce_height_m ANY NOT NULL CHECK (typeof(bounce_height_m) = 'real'),
  speed_min_mps ANY NOT NULL CHECK (typeof(speed_min_mps) = 'real'),
  speed_max_mps ANY NOT NULL CHECK (typeof(speed_max_mps) = 'real'),
  theory_name TEXT NOT NULL,
  theory_boundary_rad ANY CHECK (typeof(theory_boundary_rad) IN ('real', 'null')),
  theory_u_rad ANY NOT NULL CHECK (typeof(theory_u_rad) = 'real'),
  margin_rad ANY NOT NULL CHECK (typeof(margin_rad) = 'real'),
  created_at_utc TEXT NOT NULL CHECK (created_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  CHECK (bounce_height_m > 0 AND margin_rad > 0),
  CHECK (0 <= speed_min_mps AND speed_min_mps <= speed_max_mps),
  CHECK (CASE WHEN diameter_m IS NULL THEN diameter_m_absent IS NOT NULL AND coalesce(diameter_m_u, diameter_m_low, diameter_m_high) IS NULL ELSE diameter_m_absent IS NULL AND typeof(diameter_m) = 'real' AND typeof(diameter_m_u) = 'real' AND diameter_m_u >= 0 AND typeof(diameter_m_low) IN ('real', 'null') AND typeof(diameter_m_high) = typeof(diameter_m_low) AND coalesce(diameter_m_low <= diameter_m_high, 1) END),
  CHECK (CASE WHEN long_m IS NULL THEN long_m_absent IS NOT NULL AND coalesce(long_m_u, long_m_low, long_m_high) IS NULL ELSE long_m_absent IS NULL AND typeof(long_m) = 'real' AND typeof(long_m_u) = 'real' AND long_m_u >= 0 AND typeof(long_m_low) IN ('real', 'null') AND typeof(long_m_high) = typeof(long_m_low) AND coalesce(long_m_low <= long_m_high, 1) END),
  CHECK (CASE WHEN short_m IS NULL THEN short_m_absent IS NOT NULL AND coalesce(short_m_u, short_m_low, short_m_high) IS NULL ELSE short_m_absent IS NULL AND typeof(short_m) = 'real' AND typeof(short_m_u) = 'real' AND short_m_u >= 0 AND typeof(short_m_low) IN ('real', 'null') AND typeof(short_m_high) = typeof(short_m_low) AND coalesce(short_m_low <= short_m_high, 1) END)
) STRICT;
INSERT INTO campaigns VALUES(1,'b437f158-2946-420b-8af1-94a1ea48719a','asphalt','sphere',0.040000000000000000832,2.0000000000000001634e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',1,'approach',0.00080000000000000003833,0.0,0.0,'published',0.20594885173533089561,0.0,0.017453292519943295474,'2026-11-21T11:19:23.359Z');
CREATE TABLE clip_digests (
  clip_id INTEGER PRIMARY KEY REFERENCES clips (id),
  sha256 TEXT NOT NULL CHECK (length(sha256) = 64)
) STRICT;
CREATE TABLE clips (
  id INTEGER PRIMARY KEY,
  clip_id TEXT NOT NULL CHECK (clip_id <> ''),
  sha256 TEXT CHECK (sha256 <> ''),
  size_bytes INTEGER NOT NULL CHECK (size_bytes >= 0),
  last_seen_path TEXT NOT NULL,
  last_seen_at_utc TEXT NOT NULL CHECK (last_seen_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  UNIQUE (clip_id, sha256)
) STRICT;
CREATE TABLE conditions (
  revision_id INTEGER PRIMARY KEY REFERENCES revisions (id)
    DEFERRABLE INITIALLY DEFERRED,
  rig_id INTEGER REFERENCES rigs (id),
  spring_id INTEGER REFERENCES springs (id),
  camera_id INTEGER REFERENCES cameras (id),
  calibration_id INTEGER REFERENCES calibrations (id),
  body_id INTEGER REFERENCES bodies (id),
  surface_id INTEGER REFERENCES surfaces (id),
  operator_id INTEGER REFERENCES operators (id),
  anomaly TEXT NOT NULL CHECK (anomaly = 'none' OR anomaly = 'rig' OR anomaly = 'camera' OR anomaly = 'light' OR anomaly = 'body' OR anomaly = 'surface' OR anomaly = 'operator' OR anomaly = 'other' OR anomaly = 'not applicable' OR anomaly = 'not recorded'),
  anomaly_note TEXT NOT NULL,
  temperature_k ANY, temperature_k_u ANY, temperature_k_low ANY, temperature_k_high ANY, temperature_k_absent TEXT,
  relative_humidity ANY, relative_humidity_u ANY, relative_humidity_low ANY, relative_humidity_high ANY, relative_humidity_absent TEXT,
  CHECK (CASE WHEN temperature_k IS NULL THEN temperature_k_absent IS NOT NULL AND coalesce(temperature_k_u, temperature_k_low, temperature_k_high) IS NULL ELSE temperature_k_absent IS NULL AND typeof(temperature_k) = 'real' AND typeof(temperature_k_u) = 'real' AND temperature_k_u >= 0 AND typeof(temperature_k_low) IN ('real', 'null') AND typeof(temperature_k_high) = typeof(temperature_k_low) AND coalesce(temperature_k_low <= temperature_k_high, 1) END),
  CHECK (CASE WHEN relative_humidity IS NULL THEN relative_humidity_absent IS NOT NULL AND coalesce(relative_humidity_u, relative_humidity_low, relative_humidity_high) IS NULL ELSE relative_humidity_absent IS NULL AND typeof(relative_humidity) = 'real' AND typeof(relative_humidity_u) = 'real' AND relative_humidity_u >= 0 AND typeof(relative_humidity_low) IN ('real', 'null') AND typeof(relative_humidity_high) = typeof(relative_humidity_low) AND coalesce(relative_humidity_low <= relative_humidity_high, 1) END)
) STRICT;
INSERT INTO conditions VALUES(1,1,1,NULL,NULL,NULL,NULL,NULL,'light','',294.64999999999997727,0.5,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded');
CREATE TABLE contacts (
  revision_id INTEGER NOT NULL REFERENCES statements (revision_id),
  ordinal INTEGER NOT NULL CHECK (ordinal >= 0),
  found INTEGER NOT NULL CHECK (found IN (0, 1)),
  not_found_because TEXT NOT NULL,
  from_start INTEGER NOT NULL CHECK (from_start IN (0, 1)),
  corner TEXT CHECK (corner = 'leading' OR corner = 'trailing' OR corner = 'flush'),
  state TEXT NOT NULL CHECK (state = 'bounce' OR state = 'slide' OR state = 'roll-slide' OR state = 'roll' OR state = 'stick' OR state = 'stays-down' OR state = 'undecided'),
  p_bounce ANY CHECK (typeof(p_bounce) IN ('real', 'null')),
  state_because TEXT NOT NULL,
  micro_bounce INTEGER NOT NULL CHECK (micro_bounce IN (0, 1)),
  time_s ANY, time_s_u ANY, time_s_low ANY, time_s_high ANY, time_s_absent TEXT,
  frame ANY, frame_u ANY, frame_low ANY, frame_high ANY, frame_absent TEXT,
  approach_angle_rad ANY, approach_angle_rad_u ANY, approach_angle_rad_low ANY, approach_angle_rad_high ANY, approach_angle_rad_absent TEXT,
  radius_angle_rad ANY, radius_angle_rad_u ANY, radius_angle_rad_low ANY, radius_angle_rad_high ANY, radius_angle_rad_absent TEXT,
  face_angle_rad ANY, face_angle_rad_u ANY, face_angle_rad_low ANY, face_angle_rad_high ANY, face_angle_rad_absent TEXT,
  duration_s ANY, duration_s_u ANY, duration_s_low ANY, duration_s_high ANY, duration_s_absent TEXT,
  max_gap_m ANY, max_gap_m_u ANY, max_gap_m_low ANY, max_gap_m_high ANY, max_gap_m_absent TEXT,
  bounce_height_m ANY, bounce_height_m_u ANY, bounce_height_m_low ANY, bounce_height_m_high ANY, bounce_height_m_absent TEXT,
  detectable_gap_m ANY, detectable_gap_m_u ANY, detectable_gap_m_low ANY, detectable_gap_m_high ANY, detectable_gap_m_absent TEXT,
  before_speed_mps ANY, before_speed_mps_u ANY, before_speed_mps_low ANY, before_speed_mps_high ANY, before_speed_mps_absent TEXT,
  before_normal_mps ANY, before_normal_mps_u ANY, before_normal_mps_low ANY, before_normal_mps_high ANY, before_normal_mps_absent TEXT,
  before_tangential_mps ANY, before_tangential_mps_u ANY, before_tangential_mps_low ANY, before_tangential_mps_high ANY, before_tangential_mps_absent TEXT,
  before_omega_rad_per_s ANY, before_omega_rad_per_s_u ANY, before_omega_rad_per_s_low ANY, before_omega_rad_per_s_high ANY, before_omega_rad_per_s_absent TEXT,
  after_normal_mps ANY, after_normal_mps_u ANY, after_normal_mps_low ANY, after_normal_mps_high ANY, after_normal_mps_absent TEXT,
  after_tangential_mps ANY, after_tangential_mps_u ANY, after_tangential_mps_low ANY, after_tangential_mps_high ANY, after_tangential_mps_absent TEXT,
  after_omega_rad_per_s ANY, after_omega_rad_per_s_u ANY, after_omega_rad_per_s_low ANY, after_omega_rad_per_s_high ANY, after_omega_rad_per_s_absent TEXT,
  restitution ANY, restitution_u ANY, restitution_low ANY, restitution_high ANY, restitution_absent TEXT,
  centre_rebound_ratio ANY, centre_rebound_ratio_u ANY, centre_rebound_ratio_low ANY, centre_rebound_ratio_high ANY, centre_rebound_ratio_absent TEXT,
  impulse_ratio ANY, impulse_ratio_u ANY, impulse_ratio_low ANY, impulse_ratio_high ANY, impulse_ratio_absent TEXT,
  gravity_check_mps2 ANY, gravity_check_mps2_u ANY, gravity_check_mps2_low ANY, gravity_check_mps2_high ANY, gravity_check_mps2_absent TEXT,
  extrapolated_gap_m ANY, extrapolated_gap_m_u ANY, extrapolated_gap_m_low ANY, extrapolated_gap_m_high ANY, extrapolated_gap_m_absent TEXT,
  PRIMARY KEY (revision_id, ordinal),
  CHECK (CASE WHEN time_s IS NULL THEN time_s_absent IS NOT NULL AND coalesce(time_s_u, time_s_low, time_s_high) IS NULL ELSE time_s_absent IS NULL AND typeof(time_s) = 'real' AND typeof(time_s_u) = 'real' AND time_s_u >= 0 AND typeof(time_s_low) IN ('real', 'null') AND typeof(time_s_high) = typeof(time_s_low) AND coalesce(time_s_low <= time_s_high, 1) END),
  CHECK (CASE WHEN frame IS NULL THEN frame_absent IS NOT NULL AND coalesce(frame_u, frame_low, frame_high) IS NULL ELSE frame_absent IS NULL AND typeof(frame) = 'real' AND typeof(frame_u) = 'real' AND frame_u >= 0 AND typeof(frame_low) IN ('real', 'null') AND typeof(frame_high) = typeof(frame_low) AND coalesce(frame_low <= frame_high, 1) END),
  CHECK (CASE WHEN approach_angle_rad IS NULL THEN approach_angle_rad_absent IS NOT NULL AND coalesce(approach_angle_rad_u, approach_angle_rad_low, approach_angle_rad_high) IS NULL ELSE approach_angle_rad_absent IS NULL AND typeof(approach_angle_rad) = 'real' AND typeof(approach_angle_rad_u) = 'real' AND approach_angle_rad_u >= 0 AND typeof(approach_angle_rad_low) IN ('real', 'null') AND typeof(approach_angle_rad_high) = typeof(approach_angle_rad_low) AND coalesce(approach_angle_rad_low <= approach_angle_rad_high, 1) END),
  CHECK (CASE WHEN radius_angle_rad IS NULL THEN radius_angle_rad_absent IS NOT NULL AND coalesce(radius_angle_rad_u, radius_angle_rad_low, radius_angle_rad_high) IS NULL ELSE radius_angle_rad_absent IS NULL AND typeof(radius_angle_rad) = 'real' AND typeof(radius_angle_rad_u) = 'real' AND radius_angle_rad_u >= 0 AND typeof(radius_angle_rad_low) IN ('real', 'null') AND typeof(radius_angle_rad_high) = typeof(radius_angle_rad_low) AND coalesce(radius_angle_rad_low <= radius_angle_rad_high, 1) END),
  CHECK (CASE WHEN face_angle_rad IS NULL THEN face_angle_rad_absent IS NOT NULL AND coalesce(face_angle_rad_u, face_angle_rad_low, face_angle_rad_high) IS NULL ELSE face_angle_rad_absent IS NULL AND typeof(face_angle_rad) = 'real' AND typeof(face_angle_rad_u) = 'real' AND face_angle_rad_u >= 0 AND typeof(face_angle_rad_low) IN ('real', 'null') AND typeof(face_angle_rad_high) = typeof(face_angle_rad_low) AND coalesce(face_angle_rad_low <= face_angle_rad_high, 1) END),
  CHECK (CASE WHEN duration_s IS NULL THEN duration_s_absent IS NOT NULL AND coalesce(duration_s_u, duration_s_low, duration_s_high) IS NULL ELSE duration_s_absent IS NULL AND typeof(duration_s) = 'real' AND typeof(duration_s_u) = 'real' AND duration_s_u >= 0 AND typeof(duration_s_low) IN ('real', 'null') AND typeof(duration_s_high) = typeof(duration_s_low) AND coalesce(duration_s_low <= duration_s_high, 1) END),
  CHECK (CASE WHEN max_gap_m IS NULL THEN max_gap_m_absent IS NOT NULL AND coalesce(max_gap_m_u, max_gap_m_low, max_gap_m_high) IS NULL ELSE max_gap_m_absent IS NULL AND typeof(max_gap_m) = 'real' AND typeof(max_gap_m_u) = 'real' AND max_gap_m_u >= 0 AND typeof(max_gap_m_low) IN ('real', 'null') AND typeof(max_gap_m_high) = typeof(max_gap_m_low) AND coalesce(max_gap_m_low <= max_gap_m_high, 1) END),
  CHECK (CASE WHEN bounce_height_m IS NULL THEN bounce_height_m_absent IS NOT NULL AND coalesce(bounce_height_m_u, bounce_height_m_low, bounce_height_m_high) IS NULL ELSE bounce_height_m_absent IS NULL AND typeof(bounce_height_m) = 'real' AND typeof(bounce_height_m_u) = 'real' AND bounce_height_m_u >= 0 AND typeof(bounce_height_m_low) IN ('real', 'null') AND typeof(bounce_height_m_high) = typeof(bounce_height_m_low) AND coalesce(bounce_height_m_low <= bounce_height_m_high, 1) END),
  CHECK (CASE WHEN detectable_gap_m IS NULL THEN detectable_gap_m_absent IS NOT NULL AND coalesce(detectable_gap_m_u, detectable_gap_m_low, detectable_gap_m_high) IS NULL ELSE detectable_gap_m_absent IS NULL AND typeof(detectable_gap_m) = 'real' AND typeof(detectable_gap_m_u) = 'real' AND detectable_gap_m_u >= 0 AND typeof(detectable_gap_m_low) IN ('real', 'null') AND typeof(detectable_gap_m_high) = typeof(detectable_gap_m_low) AND coalesce(detectable_gap_m_low <= detectable_gap_m_high, 1) END),
  CHECK (CASE WHEN before_speed_mps IS NULL THEN before_speed_mps_absent IS NOT NULL AND coalesce(before_speed_mps_u, before_speed_mps_low, before_speed_mps_high) IS NULL ELSE before_speed_mps_absent IS NULL AND typeof(before_speed_mps) = 'real' AND typeof(before_speed_mps_u) = 'real' AND before_speed_mps_u >= 0 AND typeof(before_speed_mps_low) IN ('real', 'null') AND typeof(before_speed_mps_high) = typeof(before_speed_mps_low) AND coalesce(before_speed_mps_low <= before_speed_mps_high, 1) END),
  CHECK (CASE WHEN before_normal_mps IS NULL THEN before_normal_mps_absent IS NOT NULL AND coalesce(before_normal_mps_u, before_normal_mps_low, before_normal_mps_high) IS NULL ELSE before_normal_mps_absent IS NULL AND typeof(before_normal_mps) = 'real' AND typeof(before_normal_mps_u) = 'real' AND before_normal_mps_u >= 0 AND typeof(before_normal_mps_low) IN ('real', 'null') AND typeof(before_normal_mps_high) = typeof(before_normal_mps_low) AND coalesce(before_normal_mps_low <= before_normal_mps_high, 1) END),
  CHECK (CASE WHEN before_tangential_mps IS NULL THEN before_tangential_mps_absent IS NOT NULL AND coalesce(before_tangential_mps_u, before_tangential_mps_low, before_tangential_mps_high) IS NULL ELSE before_tangential_mps_absent IS NULL AND typeof(before_tangential_mps) = 'real' AND typeof(before_tangential_mps_u) = 'real' AND before_tangential_mps_u >= 0 AND typeof(before_tangential_mps_low) IN ('real', 'null') AND typeof(before_tangential_mps_high) = typeof(before_tangential_mps_low) AND coalesce(before_tangential_mps_low <= before_tangential_mps_high, 1) END),
  CHECK (CASE WHEN before_omega_rad_per_s IS NULL THEN before_omega_rad_per_s_absent IS NOT NULL AND coalesce(before_omega_rad_per_s_u, before_omega_rad_per_s_low, before_omega_rad_per_s_high) IS NULL ELSE before_omega_rad_per_s_absent IS NULL AND typeof(before_omega_rad_per_s) = 'real' AND typeof(before_omega_rad_per_s_u) = 'real' AND before_omega_rad_per_s_u >= 0 AND typeof(before_omega_rad_per_s_low) IN ('real', 'null') AND typeof(before_omega_rad_per_s_high) = typeof(before_omega_rad_per_s_low) AND coalesce(before_omega_rad_per_s_low <= before_omega_rad_per_s_high, 1) END),
  CHECK (CASE WHEN after_normal_mps IS NULL THEN after_normal_mps_absent IS NOT NULL AND coalesce(after_normal_mps_u, after_normal_mps_low, after_normal_mps_high) IS NULL ELSE after_normal_mps_absent IS NULL AND typeof(after_normal_mps) = 'real' AND typeof(after_normal_mps_u) = 'real' AND after_normal_mps_u >= 0 AND typeof(after_normal_mps_low) IN ('real', 'null') AND typeof(after_normal_mps_high) = typeof(after_normal_mps_low) AND coalesce(after_normal_mps_low <= after_normal_mps_high, 1) END),
  CHECK (CASE WHEN after_tangential_mps IS NULL THEN after_tangential_mps_absent IS NOT NULL AND coalesce(after_tangential_mps_u, after_tangential_mps_low, after_tangential_mps_high) IS NULL ELSE after_tangential_mps_absent IS NULL AND typeof(after_tangential_mps) = 'real' AND typeof(after_tangential_mps_u) = 'real' AND after_tangential_mps_u >= 0 AND typeof(after_tangential_mps_low) IN ('real', 'null') AND typeof(after_tangential_mps_high) = typeof(after_tangential_mps_low) AND coalesce(after_tangential_mps_low <= after_tangential_mps_high, 1) END),
  CHECK (CASE WHEN after_omega_rad_per_s IS NULL THEN after_omega_rad_per_s_absent IS NOT NULL AND coalesce(after_omega_rad_per_s_u, after_omega_rad_per_s_low, after_omega_rad_per_s_high) IS NULL ELSE after_omega_rad_per_s_absent IS NULL AND typeof(after_omega_rad_per_s) = 'real' AND typeof(after_omega_rad_per_s_u) = 'real' AND after_omega_rad_per_s_u >= 0 AND typeof(after_omega_rad_per_s_low) IN ('real', 'null') AND typeof(after_omega_rad_per_s_high) = typeof(after_omega_rad_per_s_low) AND coalesce(after_omega_rad_per_s_low <= after_omega_rad_per_s_high, 1) END),
  CHECK (CASE WHEN restitution IS NULL THEN restitution_absent IS NOT NULL AND coalesce(restitution_u, restitution_low, restitution_high) IS NULL ELSE restitution_absent IS NULL AND typeof(restitution) = 'real' AND typeof(restitution_u) = 'real' AND restitution_u >= 0 AND typeof(restitution_low) IN ('real', 'null') AND typeof(restitution_high) = typeof(restitution_low) AND coalesce(restitution_low <= restitution_high, 1) END),
  CHECK (CASE WHEN centre_rebound_ratio IS NULL THEN centre_rebound_ratio_absent IS NOT NULL AND coalesce(centre_rebound_ratio_u, centre_rebound_ratio_low, centre_rebound_ratio_high) IS NULL ELSE centre_rebound_ratio_absent IS NULL AND typeof(centre_rebound_ratio) = 'real' AND typeof(centre_rebound_ratio_u) = 'real' AND centre_rebound_ratio_u >= 0 AND typeof(centre_rebound_ratio_low) IN ('real', 'null') AND typeof(centre_rebound_ratio_high) = typeof(centre_rebound_ratio_low) AND coalesce(centre_rebound_ratio_low <= centre_rebound_ratio_high, 1) END),
  CHECK (CASE WHEN impulse_ratio IS NULL THEN impulse_ratio_absent IS NOT NULL AND coalesce(impulse_ratio_u, impulse_ratio_low, impulse_ratio_high) IS NULL ELSE impulse_ratio_absent IS NULL AND typeof(impulse_ratio) = 'real' AND typeof(impulse_ratio_u) = 'real' AND impulse_ratio_u >= 0 AND typeof(impulse_ratio_low) IN ('real', 'null') AND typeof(impulse_ratio_high) = typeof(impulse_ratio_low) AND coalesce(impulse_ratio_low <= impulse_ratio_high, 1) END),
  CHECK (CASE WHEN gravity_check_mps2 IS NULL THEN gravity_check_mps2_absent IS NOT NULL AND coalesce(gravity_check_mps2_u, gravity_check_mps2_low, gravity_check_mps2_high) IS NULL ELSE gravity_check_mps2_absent IS NULL AND typeof(gravity_check_mps2) = 'real' AND typeof(gravity_check_mps2_u) = 'real' AND gravity_check_mps2_u >= 0 AND typeof(gravity_check_mps2_low) IN ('real', 'null') AND typeof(gravity_check_mps2_high) = typeof(gravity_check_mps2_low) AND coalesce(gravity_check_mps2_low <= gravity_check_mps2_high, 1) END),
  CHECK (CASE WHEN extrapolated_gap_m IS NULL THEN extrapolated_gap_m_absent IS NOT NULL AND coalesce(extrapolated_gap_m_u, extrapolated_gap_m_low, extrapolated_gap_m_high) IS NULL ELSE extrapolated_gap_m_absent IS NULL AND typeof(extrapolated_gap_m) = 'real' AND typeof(extrapolated_gap_m_u) = 'real' AND extrapolated_gap_m_u >= 0 AND typeof(extrapolated_gap_m_low) IN ('real', 'null') AND typeof(extrapolated_gap_m_high) = typeof(extrapolated_gap_m_low) AND coalesce(extrapolated_gap_m_low <= extrapolated_gap_m_high, 1) END)
) STRICT;
INSERT INTO contacts VALUES(1,0,1,'',0,NULL,'bounce',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.3490658503988658956,0.0087266462599716477371,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.00080000000000000003833,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
INSERT INTO contacts VALUES(2,0,1,'',0,NULL,'slide',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.13962634015954636379,0.0087266462599716477371,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.00080000000000000003833,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
INSERT INTO contacts VALUES(3,0,1,'',0,'leading','bounce',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.69813170079773179121,0.0087266462599716477371,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
INSERT INTO contacts VALUES(4,0,1,'',0,NULL,'roll',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.13962634015954636379,0.0087266462599716477371,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.00080000000000000003833,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
INSERT INTO contacts VALUES(6,0,1,'',0,NULL,'undecided',NULL,'the film ends while the body rises',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.13962634015954636379,0.0087266462599716477371,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.00080000000000000003833,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.0020999999999999998702,0.00029999999999999997371,NULL,NULL,NULL);
CREATE TABLE digests (
  trial_id INTEGER PRIMARY KEY REFERENCES trials (id),
  revisions INTEGER NOT NULL CHECK (revisions >= 1),
  sha256 TEXT NOT NULL CHECK (length(sha256) = 64)
) STRICT;
INSERT INTO digests VALUES(1,1,'39fc37909f3b420f9ac2a7189116c7ae4a61c19b04a85cad3794ef447e6e658f');
INSERT INTO digests VALUES(2,4,'5faea32623b6458dee2f944d1d36dc3c69a69400a47e60f4dd1f166dd1315d7a');
INSERT INTO digests VALUES(3,1,'362c08d9621c6567293be0e5a33b4fb8a8524274c2c8e93eafec34a693853f09');
CREATE TABLE exclusions (
  revision_id INTEGER PRIMARY KEY REFERENCES revisions (id)
    DEFERRABLE INITIALLY DEFERRED,
  reason TEXT NOT NULL
) STRICT;
INSERT INTO exclusions VALUES(5,'the lamp failed');
CREATE TABLE operators (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  recorded_at_utc TEXT NOT NULL CHECK (recorded_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  note TEXT NOT NULL
) STRICT;
CREATE TABLE plan_events (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  campaign_id INTEGER NOT NULL REFERENCES campaigns (id),
  kind TEXT NOT NULL CHECK (kind = 'plan' OR kind = 'look'),
  design TEXT NOT NULL,
  stopping_rule TEXT NOT NULL,
  error_rates TEXT NOT NULL,
  trials INTEGER NOT NULL CHECK (trials >= 0),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  at_utc TEXT NOT NULL CHECK (at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z')
) STRICT;
INSERT INTO plan_events VALUES(1,'c6ac3b5a-70a3-4dc0-8f62-9264671bbf6b',1,'plan','ascending 2 deg steps','after 40 trials','false verdicts below 5 %',2,'A. Tester','declared late','2026-08-01T00:00:00.000Z');
INSERT INTO plan_events VALUES(2,'cd8606b0-f43c-4773-8ea4-e899bddc2a76',1,'look','','','',2,'report','','2026-08-01T00:00:01.000Z');
CREATE TABLE revisions (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  trial_id INTEGER NOT NULL REFERENCES trials (id),
  number INTEGER NOT NULL CHECK (number >= 1),
  kind TEXT NOT NULL CHECK (kind = 'logged' OR kind = 'corrected' OR kind = 'excluded' OR kind = 'included' OR kind = 'merged' OR kind = 'proposed'),
  statement_id INTEGER NOT NULL REFERENCES statements (revision_id),
  exclusion_id INTEGER REFERENCES exclusions (revision_id),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  recorded_at_utc TEXT NOT NULL CHECK (recorded_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  conditions_id INTEGER REFERENCES conditions (revision_id),
  UNIQUE (trial_id, number)
) STRICT;
INSERT INTO revisions VALUES(1,'674e0d8e-533b-4e06-874d-3003ba6e80f4',1,1,'logged',1,NULL,'Ada','','2026-11-21T11:19:24.056Z',1);
INSERT INTO revisions VALUES(2,'c7d4ce6f-f3eb-47dc-82e8-120b487c0482',2,1,'logged',2,NULL,'Ada','','2026-11-21T11:19:24.749Z',NULL);
INSERT INTO revisions VALUES(3,'848385fa-8d84-49e7-8927-2c76512029bf',3,1,'logged',3,NULL,'Ada','','2026-11-21T11:19:25.483Z',NULL);
INSERT INTO revisions VALUES(4,'549b3f82-12d2-48cf-b15a-a054fe7d1f16',2,2,'corrected',4,NULL,'Bob','seen again','2026-11-21T11:19:27.004Z',NULL);
INSERT INTO revisions VALUES(5,'f8c90b34-2756-470f-9983-78d8df1c083e',2,3,'excluded',4,5,'Bob','the lamp failed','2026-11-21T11:19:27.780Z',NULL);
INSERT INTO revisions VALUES(6,'2f6c1a5e-7d1b-4c55-9a41-0f7b8d3e6c21',2,4,'proposed',6,5,'touchdown','','2026-11-22T08:00:00.000Z',NULL);
CREATE TABLE rigs (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  recorded_at_utc TEXT NOT NULL CHECK (recorded_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  document TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  note TEXT NOT NULL
) STRICT;
INSERT INTO rigs VALUES(1,'52d80375-146a-496c-a367-341cbc50ba32','R1',1,'Ada','','2026-11-21T11:19:21.857Z','','','the old one');
CREATE TABLE springs (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  recorded_at_utc TEXT NOT NULL CHECK (recorded_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  rig_id INTEGER REFERENCES rigs (id),
  coil_diameter_kind TEXT NOT NULL CHECK (coil_diameter_kind = 'mean' OR coil_diameter_kind = 'outer' OR coil_diameter_kind = 'inner' OR coil_diameter_kind = 'other' OR coil_diameter_kind = 'not applicable' OR coil_diameter_kind = 'not recorded'),
  wire_diameter_m ANY, wire_diameter_m_u ANY, wire_diameter_m_low ANY, wire_diameter_m_high ANY, wire_diameter_m_absent TEXT,
  coil_diameter_m ANY, coil_diameter_m_u ANY, coil_diameter_m_low ANY, coil_diameter_m_high ANY, coil_diameter_m_absent TEXT,
  active_coils ANY, active_coils_u ANY, active_coils_low ANY, active_coils_high ANY, active_coils_absent TEXT,
  shear_modulus_pa ANY, shear_modulus_pa_u ANY, shear_modulus_pa_low ANY, shear_modulus_pa_high ANY, shear_modulus_pa_absent TEXT,
  stiffness_n_per_m ANY, stiffness_n_per_m_u ANY, stiffness_n_per_m_low ANY, stiffness_n_per_m_high ANY, stiffness_n_per_m_absent TEXT,
  note TEXT NOT NULL,
  CHECK (CASE WHEN wire_diameter_m IS NULL THEN wire_diameter_m_absent IS NOT NULL AND coalesce(wire_diameter_m_u, wire_diameter_m_low, wire_diameter_m_high) IS NULL ELSE wire_diameter_m_absent IS NULL AND typeof(wire_diameter_m) = 'real' AND typeof(wire_diameter_m_u) = 'real' AND wire_diameter_m_u >= 0 AND typeof(wire_diameter_m_low) IN ('real', 'null') AND typeof(wire_diameter_m_high) = typeof(wire_diameter_m_low) AND coalesce(wire_diameter_m_low <= wire_diameter_m_high, 1) END),
  CHECK (CASE WHEN coil_diameter_m IS NULL THEN coil_diameter_m_absent IS NOT NULL AND coalesce(coil_diameter_m_u, coil_diameter_m_low, coil_diameter_m_high) IS NULL ELSE coil_diameter_m_absent IS NULL AND typeof(coil_diameter_m) = 'real' AND typeof(coil_diameter_m_u) = 'real' AND coil_diameter_m_u >= 0 AND typeof(coil_diameter_m_low) IN ('real', 'null') AND typeof(coil_diameter_m_high) = typeof(coil_diameter_m_low) AND coalesce(coil_diameter_m_low <= coil_diameter_m_high, 1) END),
  CHECK (CASE WHEN active_coils IS NULL THEN active_coils_absent IS NOT NULL AND coalesce(active_coils_u, active_coils_low, active_coils_high) IS NULL ELSE active_coils_absent IS NULL AND typeof(active_coils) = 'real' AND typeof(active_coils_u) = 'real' AND active_coils_u >= 0 AND typeof(active_coils_low) IN ('real', 'null') AND typeof(active_coils_high) = typeof(active_coils_low) AND coalesce(active_coils_low <= active_coils_high, 1) END),
  CHECK (CASE WHEN shear_modulus_pa IS NULL THEN shear_modulus_pa_absent IS NOT NULL AND coalesce(shear_modulus_pa_u, shear_modulus_pa_low, shear_modulus_pa_high) IS NULL ELSE shear_modulus_pa_absent IS NULL AND typeof(shear_modulus_pa) = 'real' AND typeof(shear_modulus_pa_u) = 'real' AND shear_modulus_pa_u >= 0 AND typeof(shear_modulus_pa_low) IN ('real', 'null') AND typeof(shear_modulus_pa_high) = typeof(shear_modulus_pa_low) AND coalesce(shear_modulus_pa_low <= shear_modulus_pa_high, 1) END),
  CHECK (CASE WHEN stiffness_n_per_m IS NULL THEN stiffness_n_per_m_absent IS NOT NULL AND coalesce(stiffness_n_per_m_u, stiffness_n_per_m_low, stiffness_n_per_m_high) IS NULL ELSE stiffness_n_per_m_absent IS NULL AND typeof(stiffness_n_per_m) = 'real' AND typeof(stiffness_n_per_m_u) = 'real' AND stiffness_n_per_m_u >= 0 AND typeof(stiffness_n_per_m_low) IN ('real', 'null') AND typeof(stiffness_n_per_m_high) = typeof(stiffness_n_per_m_low) AND coalesce(stiffness_n_per_m_low <= stiffness_n_per_m_high, 1) END)
) STRICT;
INSERT INTO springs VALUES(1,'dd70d07b-ca9e-4dc5-baeb-791384166d1b','S 3',1,'Ada','','2026-11-21T11:19:22.607Z',1,'outer',NULL,NULL,NULL,NULL,'not recorded',NULL,NULL,NULL,NULL,'not recorded',NULL,NULL,NULL,NULL,'not recorded',NULL,NULL,NULL,NULL,'not recorded',1200.0,5.0,NULL,NULL,NULL,'');
INSERT INTO springs VALUES(2,'b846d2ac-611e-4506-8754-169b464d1d5e','S 3',2,'Bob','measured again','2026-11-21T11:19:28.493Z',1,'outer',NULL,NULL,NULL,NULL,'not recorded',NULL,NULL,NULL,NULL,'not recorded',NULL,NULL,NULL,NULL,'not recorded',NULL,NULL,NULL,NULL,'not recorded',1150.0,5.0,NULL,NULL,NULL,'');
CREATE TABLE statements (
  revision_id INTEGER PRIMARY KEY REFERENCES revisions (id)
    DEFERRABLE INITIALLY DEFERRED,
  clip_path TEXT NOT NULL,
  angle_kind TEXT NOT NULL CHECK (angle_kind = 'approach' OR angle_kind = 'radius' OR angle_kind = 'face'),
  body_kind TEXT NOT NULL CHECK (body_kind IN ('sphere', 'rectangle')),
  diameter_m ANY, diameter_m_u ANY, diameter_m_low ANY, diameter_m_high ANY, diameter_m_absent TEXT,
  long_m ANY, long_m_u ANY, long_m_low ANY, long_m_high ANY, long_m_absent TEXT,
  short_m ANY, short_m_u ANY, short_m_low ANY, short_m_high ANY, short_m_absent TEXT,
  set_angle_rad ANY CHECK (typeof(set_angle_rad) IN ('real', 'null')),
  set_speed_mps ANY CHECK (typeof(set_speed_mps) IN ('real', 'null')),
  contacts INTEGER NOT NULL CHECK (contacts >= 1),
  software_version TEXT NOT NULL,
  options_hash TEXT NOT NULL,
  document_json TEXT NOT NULL,
  CHECK (CASE WHEN diameter_m IS NULL THEN diameter_m_absent IS NOT NULL AND coalesce(diameter_m_u, diameter_m_low, diameter_m_high) IS NULL ELSE diameter_m_absent IS NULL AND typeof(diameter_m) = 'real' AND typeof(diameter_m_u) = 'real' AND diameter_m_u >= 0 AND typeof(diameter_m_low) IN ('real', 'null') AND typeof(diameter_m_high) = typeof(diameter_m_low) AND coalesce(diameter_m_low <= diameter_m_high, 1) END),
  CHECK (CASE WHEN long_m IS NULL THEN long_m_absent IS NOT NULL AND coalesce(long_m_u, long_m_low, long_m_high) IS NULL ELSE long_m_absent IS NULL AND typeof(long_m) = 'real' AND typeof(long_m_u) = 'real' AND long_m_u >= 0 AND typeof(long_m_low) IN ('real', 'null') AND typeof(long_m_high) = typeof(long_m_low) AND coalesce(long_m_low <= long_m_high, 1) END),
  CHECK (CASE WHEN short_m IS NULL THEN short_m_absent IS NOT NULL AND coalesce(short_m_u, short_m_low, short_m_high) IS NULL ELSE short_m_absent IS NULL AND typeof(short_m) = 'real' AND typeof(short_m_u) = 'real' AND short_m_u >= 0 AND typeof(short_m_low) IN ('real', 'null') AND typeof(short_m_high) = typeof(short_m_low) AND coalesce(short_m_low <= short_m_high, 1) END)
) STRICT;
INSERT INTO statements VALUES(1,'','approach','sphere',0.040000000000000000832,2.0000000000000001634e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','');
INSERT INTO statements VALUES(2,'','approach','sphere',0.040000000000000000832,2.0000000000000001634e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','');
INSERT INTO statements VALUES(3,'','radius','rectangle',NULL,NULL,NULL,NULL,'not a sphere',0.059999999999999997779,2.0000000000000001634e-05,NULL,NULL,NULL,0.020000000000000000416,2.0000000000000001634e-05,NULL,NULL,NULL,NULL,NULL,1,'0.1.0','','');
INSERT INTO statements VALUES(4,'','approach','sphere',0.040000000000000000832,2.0000000000000001634e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','');
INSERT INTO statements VALUES(6,'','approach','sphere',0.040000000000000000832,2.0000000000000001634e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','{}');
CREATE TABLE store (
  id INTEGER PRIMARY KEY CHECK (id = 1),
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  created_at_utc TEXT NOT NULL CHECK (created_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z')
) STRICT;
INSERT INTO store VALUES(1,'5d349c6a-0353-4f2f-b759-d291e9d6340e','2026-11-21T11:19:21.763Z');
CREATE TABLE surfaces (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  author TEXT NOT NULL CHECK (author <> ''),
  reason TEXT NOT NULL,
  recorded_at_utc TEXT NOT NULL CHECK (recorded_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z'),
  condition TEXT NOT NULL CHECK (condition = 'dry' OR condition = 'damp' OR condition = 'wet' OR condition = 'icy' OR condition = 'loose' OR condition = 'other' OR condition = 'not applicable' OR condition = 'not recorded'),
  friction ANY, friction_u ANY, friction_low ANY, friction_high ANY, friction_absent TEXT,
  friction_method TEXT NOT NULL,
  note TEXT NOT NULL,
  CHECK (CASE WHEN friction IS NULL THEN friction_absent IS NOT NULL AND coalesce(friction_u, friction_low, friction_high) IS NULL ELSE friction_absent IS NULL AND typeof(friction) = 'real' AND typeof(friction_u) = 'real' AND friction_u >= 0 AND typeof(friction_low) IN ('real', 'null') AND typeof(friction_high) = typeof(friction_low) AND coalesce(friction_low <= friction_high, 1) END)
) STRICT;
INSERT INTO surfaces VALUES(1,'b437f158-2946-420b-8af1-94a1ea48719a','asphalt, dry',1,'touchdown','named by a campaign','2026-11-21T11:19:23.359Z','not recorded',NULL,NULL,NULL,NULL,'not recorded','','');
CREATE TABLE trials (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  campaign_id INTEGER REFERENCES campaigns (id),
  clip_id INTEGER REFERENCES clips (id),
  origin TEXT NOT NULL CHECK (origin = 'recorded' OR origin = 'simulated' OR origin = 'manual'),
  logged_at_utc TEXT NOT NULL CHECK (logged_at_utc GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z')
) STRICT;
INSERT INTO trials VALUES(1,'007a8ebb-0815-4fc7-b32c-a54c4fea588c',1,NULL,'manual','2026-11-21T11:19:24.056Z');
INSERT INTO trials VALUES(2,'11019f4b-0ede-400e-b645-62016b5dff76',1,NULL,'manual','2026-11-21T11:19:24.749Z');
INSERT INTO trials VALUES(3,'51c76cf4-38db-4875-b9da-a234aed314c3',NULL,NULL,'manual','2026-11-21T11:19:25.483Z');
CREATE TABLE plan_digests (
  campaign_id INTEGER PRIMARY KEY REFERENCES campaigns (id),
  events INTEGER NOT NULL CHECK (events >= 1),
  sha256 TEXT NOT NULL CHECK (length(sha256) = 64)
) STRICT;
INSERT INTO plan_digests VALUES(1,2,'8b3c859a379353cf81265fae5e99b318146bc409c7de7f8b4d0702ed381dd8ce');
CREATE UNIQUE INDEX rigs_by_name
  ON rigs (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX cameras_by_name
  ON cameras (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX springs_by_name
  ON springs (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX calibrations_by_name
  ON calibrations (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX bodies_by_name
  ON bodies (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX surfaces_by_name
  ON surfaces (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX operators_by_name
  ON operators (name, version, recorded_at_utc, uuid);
CREATE INDEX clips_by_sha256 ON clips (sha256);
CREATE UNIQUE INDEX trials_by_campaign_and_clip
  ON trials (ifnull(campaign_id, 0), clip_id);
CREATE INDEX trials_by_date ON trials (logged_at_utc);
CREATE TRIGGER trials_refuse_UPDATE BEFORE UPDATE ON trials BEGIN
  SELECT raise(ABORT, 'trials is append-only: add a revision');
END;
CREATE TRIGGER trials_refuse_DELETE BEFORE DELETE ON trials BEGIN
  SELECT raise(ABORT, 'trials is append-only: add a revision');
END;
CREATE TRIGGER revisions_refuse_UPDATE BEFORE UPDATE ON revisions BEGIN
  SELECT raise(ABORT, 'revisions is append-only: add a revision');
END;
CREATE TRIGGER revisions_refuse_DELETE BEFORE DELETE ON revisions BEGIN
  SELECT raise(ABORT, 'revisions is append-only: add a revision');
END;
CREATE TRIGGER statements_refuse_UPDATE BEFORE UPDATE ON statements BEGIN
  SELECT raise(ABORT, 'statements is append-only: add a revision');
END;
CREATE TRIGGER statements_refuse_DELETE BEFORE DELETE ON statements BEGIN
  SELECT raise(ABORT, 'statements is append-only: add a revision');
END;
CREATE TRIGGER contacts_refuse_UPDATE BEFORE UPDATE ON contacts BEGIN
  SELECT raise(ABORT, 'contacts is append-only: add a revision');
END;
CREATE TRIGGER contacts_refuse_DELETE BEFORE DELETE ON contacts BEGIN
  SELECT raise(ABORT, 'contacts is append-only: add a revision');
END;
CREATE TRIGGER budget_lines_refuse_UPDATE BEFORE UPDATE ON budget_lines BEGIN
  SELECT raise(ABORT, 'budget_lines is append-only: add a revision');
END;
CREATE TRIGGER budget_lines_refuse_DELETE BEFORE DELETE ON budget_lines BEGIN
  SELECT raise(ABORT, 'budget_lines is append-only: add a revision');
END;
CREATE TRIGGER exclusions_refuse_UPDATE BEFORE UPDATE ON exclusions BEGIN
  SELECT raise(ABORT, 'exclusions is append-only: add a revision');
END;
CREATE TRIGGER exclusions_refuse_DELETE BEFORE DELETE ON exclusions BEGIN
  SELECT raise(ABORT, 'exclusions is append-only: add a revision');
END;
CREATE TRIGGER conditions_refuse_UPDATE BEFORE UPDATE ON conditions BEGIN
  SELECT raise(ABORT, 'conditions is append-only: add a revision');
END;
CREATE TRIGGER conditions_refuse_DELETE BEFORE DELETE ON conditions BEGIN
  SELECT raise(ABORT, 'conditions is append-only: add a revision');
END;
CREATE TRIGGER statements_refuse_REPLACE BEFORE INSERT ON statements
WHEN EXISTS (SELECT 1 FROM statements WHERE revision_id = NEW.revision_id)
BEGIN SELECT raise(ABORT, 'statements is append-only: add a revision');
END;
CREATE TRIGGER exclusions_refuse_REPLACE BEFORE INSERT ON exclusions
WHEN EXISTS (SELECT 1 FROM exclusions WHERE revision_id = NEW.revision_id)
BEGIN SELECT raise(ABORT, 'exclusions is append-only: add a revision');
END;
CREATE TRIGGER conditions_refuse_REPLACE BEFORE INSERT ON conditions
WHEN EXISTS (SELECT 1 FROM conditions WHERE revision_id = NEW.revision_id)
BEGIN SELECT raise(ABORT, 'conditions is append-only: add a revision');
END;
CREATE TRIGGER budget_lines_refuse_REPLACE BEFORE INSERT ON budget_lines
WHEN EXISTS (SELECT 1 FROM budget_lines
             WHERE revision_id = NEW.revision_id
             AND ordinal = NEW.ordinal AND budget = NEW.budget
             AND line = NEW.line)
BEGIN SELECT raise(ABORT, 'budget_lines is append-only: add a revision');
END;
CREATE TRIGGER clips_keep_digest BEFORE UPDATE ON clips
WHEN NEW.clip_id <> OLD.clip_id OR NEW.size_bytes <> OLD.size_bytes
  OR (OLD.sha256 IS NOT NULL AND NEW.sha256 IS NOT OLD.sha256)
BEGIN SELECT raise(ABORT, 'a clip keeps its digest'); END;
CREATE TRIGGER clips_refuse_DELETE BEFORE DELETE ON clips
BEGIN SELECT raise(ABORT, 'clips are kept'); END;
CREATE TRIGGER campaigns_keep_conventions BEFORE UPDATE ON campaigns
WHEN EXISTS (SELECT 1 FROM trials WHERE campaign_id = OLD.id)
BEGIN SELECT raise(ABORT, 'a campaign with trials keeps its conventions'); END;
CREATE TRIGGER campaigns_refuse_DELETE BEFORE DELETE ON campaigns
BEGIN SELECT raise(ABORT, 'campaigns are kept'); END;
CREATE TRIGGER plan_events_refuse_UPDATE BEFORE UPDATE ON plan_events
BEGIN SELECT raise(ABORT, 'plan_events are kept'); END;
CREATE TRIGGER plan_events_refuse_DELETE BEFORE DELETE ON plan_events
BEGIN SELECT raise(ABORT, 'plan_events are kept'); END;
CREATE TRIGGER plan_events_refuse_REPLACE BEFORE INSERT ON plan_events
WHEN EXISTS (SELECT 1 FROM plan_events WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM plan_events WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'plan_events are kept'); END;
CREATE TRIGGER digests_grow BEFORE UPDATE ON digests
WHEN NEW.trial_id <> OLD.trial_id OR NEW.revisions <> OLD.revisions + 1
BEGIN SELECT raise(ABORT, 'a digest grows with its trial'); END;
CREATE TRIGGER plan_digests_grow BEFORE UPDATE ON plan_digests
WHEN NEW.campaign_id <> OLD.campaign_id OR NEW.events <> OLD.events + 1
BEGIN SELECT raise(ABORT, 'a digest grows with its plan'); END;
CREATE TRIGGER clip_digests_refuse_UPDATE BEFORE UPDATE ON clip_digests
BEGIN SELECT raise(ABORT, 'a clip keeps its digest'); END;
CREATE TRIGGER digests_refuse_DELETE BEFORE DELETE ON digests
BEGIN SELECT raise(ABORT, 'digests are kept'); END;
CREATE TRIGGER digests_refuse_REPLACE BEFORE INSERT ON digests
WHEN EXISTS (SELECT 1 FROM digests WHERE trial_id = NEW.trial_id)
BEGIN SELECT raise(ABORT, 'digests are kept'); END;
CREATE TRIGGER clip_digests_refuse_DELETE BEFORE DELETE ON clip_digests
BEGIN SELECT raise(ABORT, 'clip_digests are kept'); END;
CREATE TRIGGER clip_digests_refuse_REPLACE BEFORE INSERT ON clip_digests
WHEN EXISTS (SELECT 1 FROM clip_digests WHERE clip_id = NEW.clip_id)
BEGIN SELECT raise(ABORT, 'clip_digests are kept'); END;
CREATE TRIGGER plan_digests_refuse_DELETE BEFORE DELETE ON plan_digests
BEGIN SELECT raise(ABORT, 'plan_digests are kept'); END;
CREATE TRIGGER plan_digests_refuse_REPLACE BEFORE INSERT ON plan_digests
WHEN EXISTS (SELECT 1 FROM plan_digests WHERE campaign_id = NEW.campaign_id)
BEGIN SELECT raise(ABORT, 'plan_digests are kept'); END;
CREATE TRIGGER rigs_refuse_UPDATE BEFORE UPDATE ON rigs BEGIN
  SELECT raise(ABORT, 'rigs are kept: add a version');
END;
CREATE TRIGGER rigs_refuse_DELETE BEFORE DELETE ON rigs BEGIN
  SELECT raise(ABORT, 'rigs are kept: add a version');
END;
CREATE TRIGGER rigs_refuse_REPLACE BEFORE INSERT ON rigs
WHEN EXISTS (SELECT 1 FROM rigs WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM rigs WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'rigs are kept: add a version');
END;
CREATE TRIGGER cameras_refuse_UPDATE BEFORE UPDATE ON cameras BEGIN
  SELECT raise(ABORT, 'cameras are kept: add a version');
END;
CREATE TRIGGER cameras_refuse_DELETE BEFORE DELETE ON cameras BEGIN
  SELECT raise(ABORT, 'cameras are kept: add a version');
END;
CREATE TRIGGER cameras_refuse_REPLACE BEFORE INSERT ON cameras
WHEN EXISTS (SELECT 1 FROM cameras WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM cameras WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'cameras are kept: add a version');
END;
CREATE TRIGGER springs_refuse_UPDATE BEFORE UPDATE ON springs BEGIN
  SELECT raise(ABORT, 'springs are kept: add a version');
END;
CREATE TRIGGER springs_refuse_DELETE BEFORE DELETE ON springs BEGIN
  SELECT raise(ABORT, 'springs are kept: add a version');
END;
CREATE TRIGGER springs_refuse_REPLACE BEFORE INSERT ON springs
WHEN EXISTS (SELECT 1 FROM springs WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM springs WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'springs are kept: add a version');
END;
CREATE TRIGGER calibrations_refuse_UPDATE BEFORE UPDATE ON calibrations BEGIN
  SELECT raise(ABORT, 'calibrations are kept: add a version');
END;
CREATE TRIGGER calibrations_refuse_DELETE BEFORE DELETE ON calibrations BEGIN
  SELECT raise(ABORT, 'calibrations are kept: add a version');
END;
CREATE TRIGGER calibrations_refuse_REPLACE BEFORE INSERT ON calibrations
WHEN EXISTS (SELECT 1 FROM calibrations WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM calibrations WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'calibrations are kept: add a version');
END;
CREATE TRIGGER bodies_refuse_UPDATE BEFORE UPDATE ON bodies BEGIN
  SELECT raise(ABORT, 'bodies are kept: add a version');
END;
CREATE TRIGGER bodies_refuse_DELETE BEFORE DELETE ON bodies BEGIN
  SELECT raise(ABORT, 'bodies are kept: add a version');
END;
CREATE TRIGGER bodies_refuse_REPLACE BEFORE INSERT ON bodies
WHEN EXISTS (SELECT 1 FROM bodies WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM bodies WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'bodies are kept: add a version');
END;
CREATE TRIGGER surfaces_refuse_UPDATE BEFORE UPDATE ON surfaces BEGIN
  SELECT raise(ABORT, 'surfaces are kept: add a version');
END;
CREATE TRIGGER surfaces_refuse_DELETE BEFORE DELETE ON surfaces BEGIN
  SELECT raise(ABORT, 'surfaces are kept: add a version');
END;
CREATE TRIGGER surfaces_refuse_REPLACE BEFORE INSERT ON surfaces
WHEN EXISTS (SELECT 1 FROM surfaces WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM surfaces WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'surfaces are kept: add a version');
END;
CREATE TRIGGER operators_refuse_UPDATE BEFORE UPDATE ON operators BEGIN
  SELECT raise(ABORT, 'operators are kept: add a version');
END;
CREATE TRIGGER operators_refuse_DELETE BEFORE DELETE ON operators BEGIN
  SELECT raise(ABORT, 'operators are kept: add a version');
END;
CREATE TRIGGER operators_refuse_REPLACE BEFORE INSERT ON operators
WHEN EXISTS (SELECT 1 FROM operators WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM operators WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'operators are kept: add a version');
END;
CREATE TRIGGER trials_refuse_REPLACE BEFORE INSERT ON trials
WHEN EXISTS (SELECT 1 FROM trials WHERE uuid = NEW.uuid)
  OR EXISTS (SELECT 1 FROM trials WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM trials
             WHERE ifnull(campaign_id, 0) = ifnull(NEW.campaign_id, 0)
             AND clip_id = NEW.clip_id)
BEGIN SELECT raise(ABORT, 'this trial exists already'); END;
CREATE TRIGGER revisions_in_order BEFORE INSERT ON revisions
WHEN NEW.number <> 1 + (SELECT ifnull(max(number), 0) FROM revisions
                        WHERE trial_id = NEW.trial_id)
  OR EXISTS (SELECT 1 FROM revisions WHERE uuid = NEW.uuid)
  OR EXISTS (SELECT 1 FROM revisions WHERE id = NEW.id)
BEGIN SELECT raise(ABORT, 'revisions are added one after the other');
END;
CREATE TRIGGER contacts_refuse_REPLACE BEFORE INSERT ON contacts
WHEN NEW.ordinal >= (SELECT contacts FROM statements
                     WHERE revision_id = NEW.revision_id)
  OR EXISTS (SELECT 1 FROM contacts WHERE ordinal = NEW.ordinal
             AND revision_id = NEW.revision_id)
  OR EXISTS (SELECT 1 FROM contacts WHERE rowid = NEW.rowid)
BEGIN SELECT raise(ABORT, 'contacts is append-only: add a revision');
END;
CREATE TRIGGER clips_refuse_REPLACE BEFORE INSERT ON clips
WHEN EXISTS (SELECT 1 FROM clips WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM clips WHERE clip_id = NEW.clip_id
             AND sha256 = NEW.sha256)
BEGIN SELECT raise(ABORT, 'clips are kept'); END;
CREATE TRIGGER campaigns_refuse_REPLACE BEFORE INSERT ON campaigns
WHEN EXISTS (SELECT 1 FROM campaigns WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM campaigns WHERE uuid = NEW.uuid)
  OR EXISTS (SELECT 1 FROM campaigns WHERE name = NEW.name)
BEGIN SELECT raise(ABORT, 'campaigns are kept'); END;
COMMIT;

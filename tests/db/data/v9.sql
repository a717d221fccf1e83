-- A store of version 9: that of v8.sql, its views made anew.
-- Frozen: a store of this version must be read for ever.
PRAGMA application_id = 1413763924; PRAGMA user_version = 9;
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
INSERT INTO campaigns VALUES(1,'b437f158-2946-420b-8af1-94a1ea48719a','asphalt','sphere',0.04,2e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',1,'approach',0.0008,0.0,0.0,'published',0.2059488517353309,0.0,0.017453292519943295,'2026-11-21T11:19:23.359Z');
CREATE TABLE chain (
  number INTEGER PRIMARY KEY CHECK (number >= 1),
  subject TEXT NOT NULL,
  key TEXT NOT NULL,
  row_sha256 TEXT NOT NULL CHECK (length(row_sha256) = 64),
  sha256 TEXT NOT NULL CHECK (length(sha256) = 64),
  UNIQUE (subject, key)
) STRICT;
INSERT INTO chain VALUES(1,'store','5d349c6a-0353-4f2f-b759-d291e9d6340e','9895761f88c899518d110baa277ad87aed6874db9eb0c2ffdf7595932b1ffcee','bf637c41632bc686a252da047cd942e876e799691d56091c1a1b4342008f0393');
INSERT INTO chain VALUES(2,'rig','52d80375-146a-496c-a367-341cbc50ba32','07a0035715b3ff516d643991ae1970b4ade797eacc57a9fb1ff6e6f06dbacdb1','252e3b2fa4527641dbf4fd8173c9303a60f73694428d5bec17003d50e926bff4');
INSERT INTO chain VALUES(3,'spring','dd70d07b-ca9e-4dc5-baeb-791384166d1b','7dd851df092e99108249a377c9b3bc875d68ecfc2a8060101c210e2a0d962c9f','fe9474473f6fc4f591ce9bb31e329b53cfe6e0e9441e01dd9141ce135017cb09');
INSERT INTO chain VALUES(4,'spring','b846d2ac-611e-4506-8754-169b464d1d5e','e9085260bf7d40613dc8a26514fe0d503845910cb9aa7e47b80642799931d64f','9f0b3419a8636fe8e6d178bd7b12bf566e9eab9f14b7d34cba4dc74ffae3762a');
INSERT INTO chain VALUES(5,'surface','b437f158-2946-420b-8af1-94a1ea48719a','3609a429641ba3a09ca263256817a9a3b045a355c243df0c97672203c70f77d6','9efbd97d2fa6bfa3911b2e885454ab53b61f4369508bf83b63497e6bc4d10509');
INSERT INTO chain VALUES(6,'revision','674e0d8e-533b-4e06-874d-3003ba6e80f4','c42453dd6cba47fdd1ca5df380000804a8b2e8604a3e0af2c0489aa745d895fa','e0ffe978ad5c76c8ddabd01375e91cda53aaa15e83ce24cefeb92831f0ef20c2');
INSERT INTO chain VALUES(7,'revision','c7d4ce6f-f3eb-47dc-82e8-120b487c0482','4cef0d2e680d395a0034e2db2e59229fe674f72c0442d3e25eac21561ec23258','62e05373f8bca18448b582cce24e9419ef33c10216000a2bf562cd6d1cc291f3');
INSERT INTO chain VALUES(8,'revision','848385fa-8d84-49e7-8927-2c76512029bf','9980d2f98ed3b3bdc27ecb35ecef3fdc92de01d02871d8ab7f372837433224ce','dfb0014ef1ea836b1adf9de7dd61be476ead8ad4733d9de559386947a65eaef0');
INSERT INTO chain VALUES(9,'revision','549b3f82-12d2-48cf-b15a-a054fe7d1f16','93ac0ac87197c4a4f7dc5acb534ed920f53a53ea260e0f29eb2e23b949da4bdc','55a6499f89431ca2285e7252700abb6b6898a5533c3348cc70c2c4aec23ff0fa');
INSERT INTO chain VALUES(10,'revision','f8c90b34-2756-470f-9983-78d8df1c083e','f0868a5788377d858f81e3e1c2f64abaded249c7d7e10df4d827f369c7bcc5dd','3261842d127d17ad1d6ec65229703587a65dbca73e32b5a92c6ad121035cda2d');
INSERT INTO chain VALUES(11,'revision','2f6c1a5e-7d1b-4c55-9a41-0f7b8d3e6c21','68913a37cdff5c8b9c922796245ea7612acdf63fe6ebdaa54cdd5581b2618097','1305baf58520b59053f69be1a1490bf59c413fad3c62886dddae77495435253e');
INSERT INTO chain VALUES(12,'plan','c6ac3b5a-70a3-4dc0-8f62-9264671bbf6b','a3c8954fca7be47b52551bf4841ccf4b1df6650d5926ba8f1f078294183d09c3','2863687eb380eab3c9e080936eed867c592e31b50e261c5c1055acf2f38be3ca');
INSERT INTO chain VALUES(13,'plan','cd8606b0-f43c-4773-8ea4-e899bddc2a76','872f4f0f95cea9f81d0c725e214f3413e04ef0c7b727338c86cf1e003f8423d4','794ee4415758e4ab03b29a6fd8763623000ff18d01cfe11a3ae42f5f50bd7cc0');
INSERT INTO chain VALUES(14,'revision','25513ebc-dcb3-4bcf-b767-607dde0a6c39','af007c30763bc415a5e4dd54e776cd05920bdefa447147247b08a22d46f56b0d','76f9556fe8d85895edbb3d3a92bbc9eb4930614715f27073396053b29bdf8ea1');
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
  elevation_rad ANY, elevation_rad_u ANY, elevation_rad_low ANY, elevation_rad_high ANY, elevation_rad_absent TEXT,
  compression_m ANY, compression_m_u ANY, compression_m_low ANY, compression_m_high ANY, compression_m_absent TEXT,
  muzzle_height_m ANY, muzzle_height_m_u ANY, muzzle_height_m_low ANY, muzzle_height_m_high ANY, muzzle_height_m_absent TEXT,
  note TEXT,
  CHECK (CASE WHEN temperature_k IS NULL THEN temperature_k_absent IS NOT NULL AND coalesce(temperature_k_u, temperature_k_low, temperature_k_high) IS NULL ELSE temperature_k_absent IS NULL AND typeof(temperature_k) = 'real' AND typeof(temperature_k_u) = 'real' AND temperature_k_u >= 0 AND typeof(temperature_k_low) IN ('real', 'null') AND typeof(temperature_k_high) = typeof(temperature_k_low) AND coalesce(temperature_k_low <= temperature_k_high, 1) END),
  CHECK (CASE WHEN relative_humidity IS NULL THEN relative_humidity_absent IS NOT NULL AND coalesce(relative_humidity_u, relative_humidity_low, relative_humidity_high) IS NULL ELSE relative_humidity_absent IS NULL AND typeof(relative_humidity) = 'real' AND typeof(relative_humidity_u) = 'real' AND relative_humidity_u >= 0 AND typeof(relative_humidity_low) IN ('real', 'null') AND typeof(relative_humidity_high) = typeof(relative_humidity_low) AND coalesce(relative_humidity_low <= relative_humidity_high, 1) END),
  CHECK (CASE WHEN elevation_rad IS NULL THEN coalesce(elevation_rad_u, elevation_rad_low, elevation_rad_high) IS NULL ELSE elevation_rad_absent IS NULL AND typeof(elevation_rad) = 'real' AND typeof(elevation_rad_u) = 'real' AND elevation_rad_u >= 0 AND typeof(elevation_rad_low) IN ('real', 'null') AND typeof(elevation_rad_high) = typeof(elevation_rad_low) AND coalesce(elevation_rad_low <= elevation_rad_high, 1) END),
  CHECK (CASE WHEN compression_m IS NULL THEN coalesce(compression_m_u, compression_m_low, compression_m_high) IS NULL ELSE compression_m_absent IS NULL AND typeof(compression_m) = 'real' AND typeof(compression_m_u) = 'real' AND compression_m_u >= 0 AND typeof(compression_m_low) IN ('real', 'null') AND typeof(compression_m_high) = typeof(compression_m_low) AND coalesce(compression_m_low <= compression_m_high, 1) END),
  CHECK (CASE WHEN muzzle_height_m IS NULL THEN coalesce(muzzle_height_m_u, muzzle_height_m_low, muzzle_height_m_high) IS NULL ELSE muzzle_height_m_absent IS NULL AND typeof(muzzle_height_m) = 'real' AND typeof(muzzle_height_m_u) = 'real' AND muzzle_height_m_u >= 0 AND typeof(muzzle_height_m_low) IN ('real', 'null') AND typeof(muzzle_height_m_high) = typeof(muzzle_height_m_low) AND coalesce(muzzle_height_m_low <= muzzle_height_m_high, 1) END)
) STRICT;
INSERT INTO conditions VALUES(1,1,1,NULL,NULL,NULL,NULL,NULL,'light','',294.65,0.5,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded',NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL);
INSERT INTO conditions VALUES(7,1,1,NULL,NULL,NULL,NULL,NULL,'light','',294.65,0.5,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded',0.2181661564992912,0.003490658503988659,NULL,NULL,NULL,0.03025,0.0003,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'logged before it was recorded','a draught');
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
INSERT INTO contacts VALUES(1,0,1,'',0,NULL,'bounce',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.3490658503988659,0.008726646259971648,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.0008,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
INSERT INTO contacts VALUES(2,0,1,'',0,NULL,'slide',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.13962634015954636,0.008726646259971648,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.0008,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
INSERT INTO contacts VALUES(3,0,1,'',0,'leading','bounce',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.6981317007977318,0.008726646259971648,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
INSERT INTO contacts VALUES(4,0,1,'',0,NULL,'roll',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.13962634015954636,0.008726646259971648,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.0008,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
INSERT INTO contacts VALUES(6,0,1,'',0,NULL,'undecided',NULL,'the film ends while the body rises',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.13962634015954636,0.008726646259971648,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.0008,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.0021,0.0003,NULL,NULL,NULL);
INSERT INTO contacts VALUES(7,0,1,'',0,NULL,'bounce',NULL,'stated by hand',0,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.3490658503988659,0.008726646259971648,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',0.0008,0.0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand',NULL,NULL,NULL,NULL,'not recorded by hand');
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
INSERT INTO revisions VALUES(7,'25513ebc-dcb3-4bcf-b767-607dde0a6c39',1,2,'corrected',7,NULL,'Ada','read from the notebook','2026-11-23T19:39:56.410Z',7);
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
INSERT INTO statements VALUES(1,'','approach','sphere',0.04,2e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','');
INSERT INTO statements VALUES(2,'','approach','sphere',0.04,2e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','');
INSERT INTO statements VALUES(3,'','radius','rectangle',NULL,NULL,NULL,NULL,'not a sphere',0.06,2e-05,NULL,NULL,NULL,0.02,2e-05,NULL,NULL,NULL,NULL,NULL,1,'0.1.0','','');
INSERT INTO statements VALUES(4,'','approach','sphere',0.04,2e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','');
INSERT INTO statements VALUES(6,'','approach','sphere',0.04,2e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','{}');
INSERT INTO statements VALUES(7,'','approach','sphere',0.04,2e-05,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,NULL,NULL,'not a rectangle',NULL,NULL,1,'0.1.0','','');
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
CREATE UNIQUE INDEX bodies_by_name
  ON bodies (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX calibrations_by_name
  ON calibrations (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX cameras_by_name
  ON cameras (name, version, recorded_at_utc, uuid);
CREATE INDEX clips_by_sha256 ON clips (sha256);
CREATE UNIQUE INDEX operators_by_name
  ON operators (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX rigs_by_name
  ON rigs (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX springs_by_name
  ON springs (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX surfaces_by_name
  ON surfaces (name, version, recorded_at_utc, uuid);
CREATE UNIQUE INDEX trials_by_campaign_and_clip
  ON trials (ifnull(campaign_id, 0), clip_id);
CREATE INDEX trials_by_date ON trials (logged_at_utc);
CREATE VIEW v_campaigns AS SELECT
  c.name AS campaign,
  c.body_kind AS body_kind,
  c.diameter_m / 0.001 AS diameter_mm,
  c.diameter_m_u / 0.001 AS diameter_u_mm,
  c.diameter_m_low / 0.001 AS diameter_low_mm,
  c.diameter_m_high / 0.001 AS diameter_high_mm,
  c.diameter_m_absent AS diameter_mm_absent,
  c.long_m / 0.001 AS long_mm,
  c.long_m_u / 0.001 AS long_u_mm,
  c.long_m_low / 0.001 AS long_low_mm,
  c.long_m_high / 0.001 AS long_high_mm,
  c.long_m_absent AS long_mm_absent,
  c.short_m / 0.001 AS short_mm,
  c.short_m_u / 0.001 AS short_u_mm,
  c.short_m_low / 0.001 AS short_low_mm,
  c.short_m_high / 0.001 AS short_high_mm,
  c.short_m_absent AS short_mm_absent,
  f.name AS surface,
  c.angle_kind AS angle_kind,
  c.bounce_height_m / 0.001 AS bounce_height_mm,
  c.speed_min_mps AS speed_min_mps,
  c.speed_max_mps AS speed_max_mps,
  nullif(c.theory_name, '') AS theory_name,
  c.theory_boundary_rad / 0.017453292519943295 AS theory_boundary_deg,
  c.theory_u_rad / 0.017453292519943295 AS theory_u_deg,
  c.margin_rad / 0.017453292519943295 AS margin_deg,
  c.created_at_utc AS created_at_utc,
  (SELECT count(*) FROM trials WHERE campaign_id = c.id) AS trials
FROM campaigns c LEFT JOIN surfaces f ON f.id = c.surface_id
ORDER BY c.name;
CREATE VIEW v_columns (view_name, column_name, type, unit, meaning) AS VALUES
  ('v_campaigns', 'campaign', 'text', NULL, 'its name'),
  ('v_campaigns', 'body_kind', 'text', NULL, 'sphere or rectangle'),
  ('v_campaigns', 'diameter_mm', 'real', 'mm', 'of a sphere'),
  ('v_campaigns', 'diameter_u_mm', 'real', 'mm', 'standard uncertainty of diameter_mm'),
  ('v_campaigns', 'diameter_low_mm', 'real', 'mm', 'lower end of the 95 % interval of diameter_mm, where it has its own'),
  ('v_campaigns', 'diameter_high_mm', 'real', 'mm', 'upper end of the same of diameter_mm'),
  ('v_campaigns', 'diameter_mm_absent', 'text', NULL, 'why diameter_mm has no value'),
  ('v_campaigns', 'long_mm', 'real', 'mm', 'long side of a rectangle'),
  ('v_campaigns', 'long_u_mm', 'real', 'mm', 'standard uncertainty of long_mm'),
  ('v_campaigns', 'long_low_mm', 'real', 'mm', 'lower end of the 95 % interval of long_mm, where it has its own'),
  ('v_campaigns', 'long_high_mm', 'real', 'mm', 'upper end of the same of long_mm'),
  ('v_campaigns', 'long_mm_absent', 'text', NULL, 'why long_mm has no value'),
  ('v_campaigns', 'short_mm', 'real', 'mm', 'short side of a rectangle'),
  ('v_campaigns', 'short_u_mm', 'real', 'mm', 'standard uncertainty of short_mm'),
  ('v_campaigns', 'short_low_mm', 'real', 'mm', 'lower end of the 95 % interval of short_mm, where it has its own'),
  ('v_campaigns', 'short_high_mm', 'real', 'mm', 'upper end of the same of short_mm'),
  ('v_campaigns', 'short_mm_absent', 'text', NULL, 'why short_mm has no value'),
  ('v_campaigns', 'surface', 'text', NULL, 'name in the register'),
  ('v_campaigns', 'angle_kind', 'text', NULL, 'approach, radius or face: the angle that is varied'),
  ('v_campaigns', 'bounce_height_mm', 'real', 'mm', 'rising above it is what bounce means'),
  ('v_campaigns', 'speed_min_mps', 'real', 'm/s', 'lower end of the speed band'),
  ('v_campaigns', 'speed_max_mps', 'real', 'm/s', 'upper end of the speed band'),
  ('v_campaigns', 'theory_name', 'text', NULL, 'the theory declared'),
  ('v_campaigns', 'theory_boundary_deg', 'real', 'deg', 'boundary angle of that theory'),
  ('v_campaigns', 'theory_u_deg', 'real', 'deg', 'standard uncertainty of the theory'),
  ('v_campaigns', 'margin_deg', 'real', 'deg', 'equivalence margin'),
  ('v_campaigns', 'created_at_utc', 'text', NULL, 'when it was made'),
  ('v_campaigns', 'trials', 'integer', NULL, 'how many trials it has, excluded ones too'),
  ('v_trials', 'trial', 'text', NULL, 'UUID of the trial'),
  ('v_trials', 'campaign', 'text', NULL, 'name; NULL: in none'),
  ('v_trials', 'origin', 'text', NULL, 'recorded, simulated or manual: never pooled'),
  ('v_trials', 'logged_at_utc', 'text', NULL, 'when it was first logged'),
  ('v_trials', 'revision', 'integer', NULL, 'the one in force'),
  ('v_trials', 'revised_at_utc', 'text', NULL, 'when that was stated'),
  ('v_trials', 'author', 'text', NULL, 'who stated it'),
  ('v_trials', 'reason', 'text', NULL, 'why'),
  ('v_trials', 'excluded', 'integer', NULL, '1: the trial does not count'),
  ('v_trials', 'exclusion_reason', 'text', NULL, 'why not'),
  ('v_trials', 'body_kind', 'text', NULL, 'sphere or rectangle'),
  ('v_trials', 'diameter_mm', 'real', 'mm', 'of a sphere'),
  ('v_trials', 'diameter_u_mm', 'real', 'mm', 'standard uncertainty of diameter_mm'),
  ('v_trials', 'diameter_low_mm', 'real', 'mm', 'lower end of the 95 % interval of diameter_mm, where it has its own'),
  ('v_trials', 'diameter_high_mm', 'real', 'mm', 'upper end of the same of diameter_mm'),
  ('v_trials', 'diameter_mm_absent', 'text', NULL, 'why diameter_mm has no value'),
  ('v_trials', 'long_mm', 'real', 'mm', 'long side of a rectangle'),
  ('v_trials', 'long_u_mm', 'real', 'mm', 'standard uncertainty of long_mm'),
  ('v_trials', 'long_low_mm', 'real', 'mm', 'lower end of the 95 % interval of long_mm, where it has its own'),
  ('v_trials', 'long_high_mm', 'real', 'mm', 'upper end of the same of long_mm'),
  ('v_trials', 'long_mm_absent', 'text', NULL, 'why long_mm has no value'),
  ('v_trials', 'short_mm', 'real', 'mm', 'short side of a rectangle'),
  ('v_trials', 'short_u_mm', 'real', 'mm', 'standard uncertainty of short_mm'),
  ('v_trials', 'short_low_mm', 'real', 'mm', 'lower end of the 95 % interval of short_mm, where it has its own'),
  ('v_trials', 'short_high_mm', 'real', 'mm', 'upper end of the same of short_mm'),
  ('v_trials', 'short_mm_absent', 'text', NULL, 'why short_mm has no value'),
  ('v_trials', 'set_angle_deg', 'real', 'deg', 'set-point of the varied angle'),
  ('v_trials', 'set_speed_mps', 'real', 'm/s', 'set-point of the launch speed'),
  ('v_trials', 'angle_kind', 'text', NULL, 'approach, radius or face: what contact_angle_deg is'),
  ('v_trials', 'contact_angle_deg', 'real', 'deg', 'the angle that angle_kind names; of kind face its magnitude'),
  ('v_trials', 'contact_angle_u_deg', 'real', 'deg', 'its standard uncertainty'),
  ('v_trials', 'contact_angle_low_deg', 'real', 'deg', 'lower end of its 95 % interval, where it has its own'),
  ('v_trials', 'contact_angle_high_deg', 'real', 'deg', 'upper end of the same'),
  ('v_trials', 'contact_angle_deg_absent', 'text', NULL, 'why it has no value'),
  ('v_trials', 'state', 'text', NULL, 'bounce, slide, roll-slide, roll, stick, stays-down or undecided'),
  ('v_trials', 'p_bounce', 'real', NULL, 'probability of a bounce'),
  ('v_trials', 'state_because', 'text', NULL, 'evidence of the state'),
  ('v_trials', 'contacts', 'integer', NULL, 'how many v_contacts has'),
  ('v_trials', 'rig', 'text', NULL, 'name in the register'),
  ('v_trials', 'spring', 'text', NULL, 'name in the register'),
  ('v_trials', 'camera', 'text', NULL, 'name in the register'),
  ('v_trials', 'calibration', 'text', NULL, 'name in the register'),
  ('v_trials', 'body', 'text', NULL, 'name in the register'),
  ('v_trials', 'surface', 'text', NULL, 'name in the register'),
  ('v_trials', 'operator', 'text', NULL, 'name in the register'),
  ('v_trials', 'temperature_c', 'real', 'degC', 'of the air'),
  ('v_trials', 'temperature_u_c', 'real', 'degC', 'standard uncertainty of temperature_c'),
  ('v_trials', 'temperature_low_c', 'real', 'degC', 'lower end of the 95 % interval of temperature_c, where it has its own'),
  ('v_trials', 'temperature_high_c', 'real', 'degC', 'upper end of the same of temperature_c'),
  ('v_trials', 'temperature_c_absent', 'text', NULL, 'why temperature_c has no value'),
  ('v_trials', 'relative_humidity', 'real', NULL, 'of the air, 0 to 1'),
  ('v_trials', 'relative_humidity_u', 'real', NULL, 'standard uncertainty of relative_humidity'),
  ('v_trials', 'relative_humidity_low', 'real', NULL, 'lower end of the 95 % interval of relative_humidity, where it has its own'),
  ('v_trials', 'relative_humidity_high', 'real', NULL, 'upper end of the same of relative_humidity'),
  ('v_trials', 'relative_humidity_absent', 'text', NULL, 'why relative_humidity has no value'),
  ('v_trials', 'elevation_deg', 'real', 'deg', 'of the barrel above horizontal, as set'),
  ('v_trials', 'elevation_u_deg', 'real', 'deg', 'standard uncertainty of elevation_deg'),
  ('v_trials', 'elevation_low_deg', 'real', 'deg', 'lower end of the 95 % interval of elevation_deg, where it has its own'),
  ('v_trials', 'elevation_high_deg', 'real', 'deg', 'upper end of the same of elevation_deg'),
  ('v_trials', 'elevation_deg_absent', 'text', NULL, 'why elevation_deg has no value'),
  ('v_trials', 'compression_mm', 'real', 'mm', 'travel of the springs, as set'),
  ('v_trials', 'compression_u_mm', 'real', 'mm', 'standard uncertainty of compression_mm'),
  ('v_trials', 'compression_low_mm', 'real', 'mm', 'lower end of the 95 % interval of compression_mm, where it has its own'),
  ('v_trials', 'compression_high_mm', 'real', 'mm', 'upper end of the same of compression_mm'),
  ('v_trials', 'compression_mm_absent', 'text', NULL, 'why compression_mm has no value'),
  ('v_trials', 'muzzle_height_mm', 'real', 'mm', 'of the body''s centre above the ground as it leaves, as set'),
  ('v_trials', 'muzzle_height_u_mm', 'real', 'mm', 'standard uncertainty of muzzle_height_mm'),
  ('v_trials', 'muzzle_height_low_mm', 'real', 'mm', 'lower end of the 95 % interval of muzzle_height_mm, where it has its own'),
  ('v_trials', 'muzzle_height_high_mm', 'real', 'mm', 'upper end of the same of muzzle_height_mm'),
  ('v_trials', 'muzzle_height_mm_absent', 'text', NULL, 'why muzzle_height_mm has no value'),
  ('v_trials', 'anomaly', 'text', NULL, 'what was not as it should be'),
  ('v_trials', 'anomaly_note', 'text', NULL, 'what it was'),
  ('v_trials', 'note', 'text', NULL, 'the operator''s'),
  ('v_trials', 'clip_path', 'text', NULL, 'where the recording was when it was analysed'),
  ('v_trials', 'clip_id', 'text', NULL, 'clip.id of `touchdown analyze`'),
  ('v_trials', 'clip_sha256', 'text', NULL, 'of the whole recording'),
  ('v_trials', 'clip_size_bytes', 'integer', NULL, 'of the recording'),
  ('v_trials', 'software_version', 'text', NULL, 'of the analysis'),
  ('v_trials', 'options_hash', 'text', NULL, 'digest of the options of the analysis'),
  ('v_contacts', 'trial', 'text', NULL, 'UUID of the trial'),
  ('v_contacts', 'campaign', 'text', NULL, 'name; NULL: in none'),
  ('v_contacts', 'contact', 'integer', NULL, '1: the first'),
  ('v_contacts', 'found', 'integer', NULL, '1: a touchdown was seen'),
  ('v_contacts', 'not_found_because', 'text', NULL, 'why not'),
  ('v_contacts', 'from_start', 'integer', NULL, '1: on the ground from the first frame'),
  ('v_contacts', 'corner', 'text', NULL, 'of a rectangle, which came first: leading, trailing or flush'),
  ('v_contacts', 'state', 'text', NULL, 'bounce, slide, roll-slide, roll, stick, stays-down or undecided'),
  ('v_contacts', 'p_bounce', 'real', NULL, 'probability of a bounce'),
  ('v_contacts', 'state_because', 'text', NULL, 'evidence of the state'),
  ('v_contacts', 'micro_bounce', 'integer', NULL, '1: it left the ground below the bounce height'),
  ('v_contacts', 'time_s', 'real', 's', 'instant of touchdown; 0 is the middle of frame 0'),
  ('v_contacts', 'time_u_s', 'real', 's', 'standard uncertainty of time_s'),
  ('v_contacts', 'time_low_s', 'real', 's', 'lower end of the 95 % interval of time_s, where it has its own'),
  ('v_contacts', 'time_high_s', 'real', 's', 'upper end of the same of time_s'),
  ('v_contacts', 'time_s_absent', 'text', NULL, 'why time_s has no value'),
  ('v_contacts', 'frame', 'real', 'frame', 'the same instant, in frames from 0'),
  ('v_contacts', 'frame_u', 'real', NULL, 'standard uncertainty of frame'),
  ('v_contacts', 'frame_low', 'real', NULL, 'lower end of the 95 % interval of frame, where it has its own'),
  ('v_contacts', 'frame_high', 'real', NULL, 'upper end of the same of frame'),
  ('v_contacts', 'frame_absent', 'text', NULL, 'why frame has no value'),
  ('v_contacts', 'approach_angle_deg', 'real', 'deg', 'between the ground and the centre''s velocity'),
  ('v_contacts', 'approach_angle_u_deg', 'real', 'deg', 'standard uncertainty of approach_angle_deg'),
  ('v_contacts', 'approach_angle_low_deg', 'real', 'deg', 'lower end of the 95 % interval of approach_angle_deg, where it has its own'),
  ('v_contacts', 'approach_angle_high_deg', 'real', 'deg', 'upper end of the same of approach_angle_deg'),
  ('v_contacts', 'approach_angle_deg_absent', 'text', NULL, 'why approach_angle_deg has no value'),
  ('v_contacts', 'radius_angle_deg', 'real', 'deg', 'acute, of the line from the centre to the contact point'),
  ('v_contacts', 'radius_angle_u_deg', 'real', 'deg', 'standard uncertainty of radius_angle_deg'),
  ('v_contacts', 'radius_angle_low_deg', 'real', 'deg', 'lower end of the 95 % interval of radius_angle_deg, where it has its own'),
  ('v_contacts', 'radius_angle_high_deg', 'real', 'deg', 'upper end of the same of radius_angle_deg'),
  ('v_contacts', 'radius_angle_deg_absent', 'text', NULL, 'why radius_angle_deg has no value'),
  ('v_contacts', 'face_angle_deg', 'real', 'deg', 'of the long side to the ground, leading end up'),
  ('v_contacts', 'face_angle_u_deg', 'real', 'deg', 'standard uncertainty of face_angle_deg'),
  ('v_contacts', 'face_angle_low_deg', 'real', 'deg', 'lower end of the 95 % interval of face_angle_deg, where it has its own'),
  ('v_contacts', 'face_angle_high_deg', 'real', 'deg', 'upper end of the same of face_angle_deg'),
  ('v_contacts', 'face_angle_deg_absent', 'text', NULL, 'why face_angle_deg has no value'),
  ('v_contacts', 'duration_s', 'real', 's', 'from touchdown to release'),
  ('v_contacts', 'duration_u_s', 'real', 's', 'standard uncertainty of duration_s'),
  ('v_contacts', 'duration_low_s', 'real', 's', 'lower end of the 95 % interval of duration_s, where it has its own'),
  ('v_contacts', 'duration_high_s', 'real', 's', 'upper end of the same of duration_s'),
  ('v_contacts', 'duration_s_absent', 'text', NULL, 'why duration_s has no value'),
  ('v_contacts', 'max_gap_mm', 'real', 'mm', 'greatest gap between release and the end of the film'),
  ('v_contacts', 'max_gap_u_mm', 'real', 'mm', 'standard uncertainty of max_gap_mm'),
  ('v_contacts', 'max_gap_low_mm', 'real', 'mm', 'lower end of the 95 % interval of max_gap_mm, where it has its own'),
  ('v_contacts', 'max_gap_high_mm', 'real', 'mm', 'upper end of the same of max_gap_mm'),
  ('v_contacts', 'max_gap_mm_absent', 'text', NULL, 'why max_gap_mm has no value'),
  ('v_contacts', 'bounce_height_mm', 'real', 'mm', 'rising above it is what bounce means'),
  ('v_contacts', 'bounce_height_u_mm', 'real', 'mm', 'standard uncertainty of bounce_height_mm'),
  ('v_contacts', 'bounce_height_low_mm', 'real', 'mm', 'lower end of the 95 % interval of bounce_height_mm, where it has its own'),
  ('v_contacts', 'bounce_height_high_mm', 'real', 'mm', 'upper end of the same of bounce_height_mm'),
  ('v_contacts', 'bounce_height_mm_absent', 'text', NULL, 'why bounce_height_mm has no value'),
  ('v_contacts', 'detectable_gap_mm', 'real', 'mm', 'the least gap that would have been seen'),
  ('v_contacts', 'detectable_gap_u_mm', 'real', 'mm', 'standard uncertainty of detectable_gap_mm'),
  ('v_contacts', 'detectable_gap_low_mm', 'real', 'mm', 'lower end of the 95 % interval of detectable_gap_mm, where it has its own'),
  ('v_contacts', 'detectable_gap_high_mm', 'real', 'mm', 'upper end of the same of detectable_gap_mm'),
  ('v_contacts', 'detectable_gap_mm_absent', 'text', NULL, 'why detectable_gap_mm has no value'),
  ('v_contacts', 'before_speed_mps', 'real', 'm/s', 'of the centre at touchdown'),
  ('v_contacts', 'before_speed_u_mps', 'real', 'm/s', 'standard uncertainty of before_speed_mps'),
  ('v_contacts', 'before_speed_low_mps', 'real', 'm/s', 'lower end of the 95 % interval of before_speed_mps, where it has its own'),
  ('v_contacts', 'before_speed_high_mps', 'real', 'm/s', 'upper end of the same of before_speed_mps'),
  ('v_contacts', 'before_speed_mps_absent', 'text', NULL, 'why before_speed_mps has no value'),
  ('v_contacts', 'before_normal_mps', 'real', 'm/s', 'of the centre at touchdown; below 0: downward'),
  ('v_contacts', 'before_normal_u_mps', 'real', 'm/s', 'standard uncertainty of before_normal_mps'),
  ('v_contacts', 'before_normal_low_mps', 'real', 'm/s', 'lower end of the 95 % interval of before_normal_mps, where it has its own'),
  ('v_contacts', 'before_normal_high_mps', 'real', 'm/s', 'upper end of the same of before_normal_mps'),
  ('v_contacts', 'before_normal_mps_absent', 'text', NULL, 'why before_normal_mps has no value'),
  ('v_contacts', 'before_tangential_mps', 'real', 'm/s', 'of the centre at touchdown, along the ground'),
  ('v_contacts', 'before_tangential_u_mps', 'real', 'm/s', 'standard uncertainty of before_tangential_mps'),
  ('v_contacts', 'before_tangential_low_mps', 'real', 'm/s', 'lower end of the 95 % interval of before_tangential_mps, where it has its own'),
  ('v_contacts', 'before_tangential_high_mps', 'real', 'm/s', 'upper end of the same of before_tangential_mps'),
  ('v_contacts', 'before_tangential_mps_absent', 'text', NULL, 'why before_tangential_mps has no value'),
  ('v_contacts', 'before_omega_rad_per_s', 'real', 'rad/s', 'spin at touchdown, counter-clockwise'),
  ('v_contacts', 'before_omega_u_rad_per_s', 'real', 'rad/s', 'standard uncertainty of before_omega_rad_per_s'),
  ('v_contacts', 'before_omega_low_rad_per_s', 'real', 'rad/s', 'lower end of the 95 % interval of before_omega_rad_per_s, where it has its own'),
  ('v_contacts', 'before_omega_high_rad_per_s', 'real', 'rad/s', 'upper end of the same of before_omega_rad_per_s'),
  ('v_contacts', 'before_omega_rad_per_s_absent', 'text', NULL, 'why before_omega_rad_per_s has no value'),
  ('v_contacts', 'after_normal_mps', 'real', 'm/s', 'of the centre at release'),
  ('v_contacts', 'after_normal_u_mps', 'real', 'm/s', 'standard uncertainty of after_normal_mps'),
  ('v_contacts', 'after_normal_low_mps', 'real', 'm/s', 'lower end of the 95 % interval of after_normal_mps, where it has its own'),
  ('v_contacts', 'after_normal_high_mps', 'real', 'm/s', 'upper end of the same of after_normal_mps'),
  ('v_contacts', 'after_normal_mps_absent', 'text', NULL, 'why after_normal_mps has no value'),
  ('v_contacts', 'after_tangential_mps', 'real', 'm/s', 'of the centre at release, along the ground'),
  ('v_contacts', 'after_tangential_u_mps', 'real', 'm/s', 'standard uncertainty of after_tangential_mps'),
  ('v_contacts', 'after_tangential_low_mps', 'real', 'm/s', 'lower end of the 95 % interval of after_tangential_mps, where it has its own'),
  ('v_contacts', 'after_tangential_high_mps', 'real', 'm/s', 'upper end of the same of after_tangential_mps'),
  ('v_contacts', 'after_tangential_mps_absent', 'text', NULL, 'why after_tangential_mps has no value'),
  ('v_contacts', 'after_omega_rad_per_s', 'real', 'rad/s', 'spin at release, counter-clockwise'),
  ('v_contacts', 'after_omega_u_rad_per_s', 'real', 'rad/s', 'standard uncertainty of after_omega_rad_per_s'),
  ('v_contacts', 'after_omega_low_rad_per_s', 'real', 'rad/s', 'lower end of the 95 % interval of after_omega_rad_per_s, where it has its own'),
  ('v_contacts', 'after_omega_high_rad_per_s', 'real', 'rad/s', 'upper end of the same of after_omega_rad_per_s'),
  ('v_contacts', 'after_omega_rad_per_s_absent', 'text', NULL, 'why after_omega_rad_per_s has no value'),
  ('v_contacts', 'restitution', 'real', NULL, 'of the contact point''s normal velocity'),
  ('v_contacts', 'restitution_u', 'real', NULL, 'standard uncertainty of restitution'),
  ('v_contacts', 'restitution_low', 'real', NULL, 'lower end of the 95 % interval of restitution, where it has its own'),
  ('v_contacts', 'restitution_high', 'real', NULL, 'upper end of the same of restitution'),
  ('v_contacts', 'restitution_absent', 'text', NULL, 'why restitution has no value'),
  ('v_contacts', 'centre_rebound_ratio', 'real', NULL, 'of the centre''s normal velocity'),
  ('v_contacts', 'centre_rebound_ratio_u', 'real', NULL, 'standard uncertainty of centre_rebound_ratio'),
  ('v_contacts', 'centre_rebound_ratio_low', 'real', NULL, 'lower end of the 95 % interval of centre_rebound_ratio, where it has its own'),
  ('v_contacts', 'centre_rebound_ratio_high', 'real', NULL, 'upper end of the same of centre_rebound_ratio'),
  ('v_contacts', 'centre_rebound_ratio_absent', 'text', NULL, 'why centre_rebound_ratio has no value'),
  ('v_contacts', 'impulse_ratio', 'real', NULL, 'change of tangential over change of normal velocity'),
  ('v_contacts', 'impulse_ratio_u', 'real', NULL, 'standard uncertainty of impulse_ratio'),
  ('v_contacts', 'impulse_ratio_low', 'real', NULL, 'lower end of the 95 % interval of impulse_ratio, where it has its own'),
  ('v_contacts', 'impulse_ratio_high', 'real', NULL, 'upper end of the same of impulse_ratio'),
  ('v_contacts', 'impulse_ratio_absent', 'text', NULL, 'why impulse_ratio has no value'),
  ('v_contacts', 'gravity_check_mps2', 'real', 'm/s2', 'gravity fitted freely: a check of scale and frame rate'),
  ('v_contacts', 'gravity_check_u_mps2', 'real', 'm/s2', 'standard uncertainty of gravity_check_mps2'),
  ('v_contacts', 'gravity_check_low_mps2', 'real', 'm/s2', 'lower end of the 95 % interval of gravity_check_mps2, where it has its own'),
  ('v_contacts', 'gravity_check_high_mps2', 'real', 'm/s2', 'upper end of the same of gravity_check_mps2'),
  ('v_contacts', 'gravity_check_mps2_absent', 'text', NULL, 'why gravity_check_mps2 has no value'),
  ('v_contacts', 'extrapolated_gap_mm', 'real', 'mm', 'that a flight would reach which the film cut off'),
  ('v_contacts', 'extrapolated_gap_u_mm', 'real', 'mm', 'standard uncertainty of extrapolated_gap_mm'),
  ('v_contacts', 'extrapolated_gap_low_mm', 'real', 'mm', 'lower end of the 95 % interval of extrapolated_gap_mm, where it has its own'),
  ('v_contacts', 'extrapolated_gap_high_mm', 'real', 'mm', 'upper end of the same of extrapolated_gap_mm'),
  ('v_contacts', 'extrapolated_gap_mm_absent', 'text', NULL, 'why extrapolated_gap_mm has no value'),
  ('v_tracks', 'trial', 'text', NULL, 'UUID of the trial'),
  ('v_tracks', 'campaign', 'text', NULL, 'name; NULL: in none'),
  ('v_tracks', 'frame', 'integer', NULL, 'from 0'),
  ('v_tracks', 'time_s', 'real', 's', '0 is the middle of frame 0'),
  ('v_tracks', 'x_mm', 'real', 'mm', 'of the centre, along the ground in the direction of travel'),
  ('v_tracks', 'y_mm', 'real', 'mm', 'of the centre above the ground line'),
  ('v_tracks', 'gap_mm', 'real', 'mm', 'of the body''s lowest point above the ground line'),
  ('v_tracks', 'face_angle_deg', 'real', 'deg', 'of a rectangle''s long side to the ground, leading end up'),
  ('v_revisions', 'trial', 'text', NULL, 'UUID of the trial'),
  ('v_revisions', 'campaign', 'text', NULL, 'name; NULL: in none'),
  ('v_revisions', 'revision', 'integer', NULL, '1, 2, 3 ...'),
  ('v_revisions', 'kind', 'text', NULL, 'logged, corrected, excluded, included, merged or proposed'),
  ('v_revisions', 'author', 'text', NULL, 'who'),
  ('v_revisions', 'reason', 'text', NULL, 'why'),
  ('v_revisions', 'recorded_at_utc', 'text', NULL, 'when'),
  ('v_revisions', 'sha256', 'text', NULL, 'of this revision and all that was recorded before it');
CREATE VIEW v_contacts AS SELECT
  t.uuid AS trial,
  c.name AS campaign,
  f.ordinal + 1 AS contact,
  f.found AS found,
  nullif(f.not_found_because, '') AS not_found_because,
  f.from_start AS from_start,
  f.corner AS corner,
  f.state AS state,
  f.p_bounce AS p_bounce,
  f.state_because AS state_because,
  f.micro_bounce AS micro_bounce,
  f.time_s AS time_s,
  f.time_s_u AS time_u_s,
  f.time_s_low AS time_low_s,
  f.time_s_high AS time_high_s,
  f.time_s_absent AS time_s_absent,
  f.frame AS frame,
  f.frame_u AS frame_u,
  f.frame_low AS frame_low,
  f.frame_high AS frame_high,
  f.frame_absent AS frame_absent,
  f.approach_angle_rad / 0.017453292519943295 AS approach_angle_deg,
  f.approach_angle_rad_u / 0.017453292519943295 AS approach_angle_u_deg,
  f.approach_angle_rad_low / 0.017453292519943295 AS approach_angle_low_deg,
  f.approach_angle_rad_high / 0.017453292519943295 AS approach_angle_high_deg,
  f.approach_angle_rad_absent AS approach_angle_deg_absent,
  f.radius_angle_rad / 0.017453292519943295 AS radius_angle_deg,
  f.radius_angle_rad_u / 0.017453292519943295 AS radius_angle_u_deg,
  f.radius_angle_rad_low / 0.017453292519943295 AS radius_angle_low_deg,
  f.radius_angle_rad_high / 0.017453292519943295 AS radius_angle_high_deg,
  f.radius_angle_rad_absent AS radius_angle_deg_absent,
  f.face_angle_rad / 0.017453292519943295 AS face_angle_deg,
  f.face_angle_rad_u / 0.017453292519943295 AS face_angle_u_deg,
  f.face_angle_rad_low / 0.017453292519943295 AS face_angle_low_deg,
  f.face_angle_rad_high / 0.017453292519943295 AS face_angle_high_deg,
  f.face_angle_rad_absent AS face_angle_deg_absent,
  f.duration_s AS duration_s,
  f.duration_s_u AS duration_u_s,
  f.duration_s_low AS duration_low_s,
  f.duration_s_high AS duration_high_s,
  f.duration_s_absent AS duration_s_absent,
  f.max_gap_m / 0.001 AS max_gap_mm,
  f.max_gap_m_u / 0.001 AS max_gap_u_mm,
  f.max_gap_m_low / 0.001 AS max_gap_low_mm,
  f.max_gap_m_high / 0.001 AS max_gap_high_mm,
  f.max_gap_m_absent AS max_gap_mm_absent,
  f.bounce_height_m / 0.001 AS bounce_height_mm,
  f.bounce_height_m_u / 0.001 AS bounce_height_u_mm,
  f.bounce_height_m_low / 0.001 AS bounce_height_low_mm,
  f.bounce_height_m_high / 0.001 AS bounce_height_high_mm,
  f.bounce_height_m_absent AS bounce_height_mm_absent,
  f.detectable_gap_m / 0.001 AS detectable_gap_mm,
  f.detectable_gap_m_u / 0.001 AS detectable_gap_u_mm,
  f.detectable_gap_m_low / 0.001 AS detectable_gap_low_mm,
  f.detectable_gap_m_high / 0.001 AS detectable_gap_high_mm,
  f.detectable_gap_m_absent AS detectable_gap_mm_absent,
  f.before_speed_mps AS before_speed_mps,
  f.before_speed_mps_u AS before_speed_u_mps,
  f.before_speed_mps_low AS before_speed_low_mps,
  f.before_speed_mps_high AS before_speed_high_mps,
  f.before_speed_mps_absent AS before_speed_mps_absent,
  f.before_normal_mps AS before_normal_mps,
  f.before_normal_mps_u AS before_normal_u_mps,
  f.before_normal_mps_low AS before_normal_low_mps,
  f.before_normal_mps_high AS before_normal_high_mps,
  f.before_normal_mps_absent AS before_normal_mps_absent,
  f.before_tangential_mps AS before_tangential_mps,
  f.before_tangential_mps_u AS before_tangential_u_mps,
  f.before_tangential_mps_low AS before_tangential_low_mps,
  f.before_tangential_mps_high AS before_tangential_high_mps,
  f.before_tangential_mps_absent AS before_tangential_mps_absent,
  f.before_omega_rad_per_s AS before_omega_rad_per_s,
  f.before_omega_rad_per_s_u AS before_omega_u_rad_per_s,
  f.before_omega_rad_per_s_low AS before_omega_low_rad_per_s,
  f.before_omega_rad_per_s_high AS before_omega_high_rad_per_s,
  f.before_omega_rad_per_s_absent AS before_omega_rad_per_s_absent,
  f.after_normal_mps AS after_normal_mps,
  f.after_normal_mps_u AS after_normal_u_mps,
  f.after_normal_mps_low AS after_normal_low_mps,
  f.after_normal_mps_high AS after_normal_high_mps,
  f.after_normal_mps_absent AS after_normal_mps_absent,
  f.after_tangential_mps AS after_tangential_mps,
  f.after_tangential_mps_u AS after_tangential_u_mps,
  f.after_tangential_mps_low AS after_tangential_low_mps,
  f.after_tangential_mps_high AS after_tangential_high_mps,
  f.after_tangential_mps_absent AS after_tangential_mps_absent,
  f.after_omega_rad_per_s AS after_omega_rad_per_s,
  f.after_omega_rad_per_s_u AS after_omega_u_rad_per_s,
  f.after_omega_rad_per_s_low AS after_omega_low_rad_per_s,
  f.after_omega_rad_per_s_high AS after_omega_high_rad_per_s,
  f.after_omega_rad_per_s_absent AS after_omega_rad_per_s_absent,
  f.restitution AS restitution,
  f.restitution_u AS restitution_u,
  f.restitution_low AS restitution_low,
  f.restitution_high AS restitution_high,
  f.restitution_absent AS restitution_absent,
  f.centre_rebound_ratio AS centre_rebound_ratio,
  f.centre_rebound_ratio_u AS centre_rebound_ratio_u,
  f.centre_rebound_ratio_low AS centre_rebound_ratio_low,
  f.centre_rebound_ratio_high AS centre_rebound_ratio_high,
  f.centre_rebound_ratio_absent AS centre_rebound_ratio_absent,
  f.impulse_ratio AS impulse_ratio,
  f.impulse_ratio_u AS impulse_ratio_u,
  f.impulse_ratio_low AS impulse_ratio_low,
  f.impulse_ratio_high AS impulse_ratio_high,
  f.impulse_ratio_absent AS impulse_ratio_absent,
  f.gravity_check_mps2 AS gravity_check_mps2,
  f.gravity_check_mps2_u AS gravity_check_u_mps2,
  f.gravity_check_mps2_low AS gravity_check_low_mps2,
  f.gravity_check_mps2_high AS gravity_check_high_mps2,
  f.gravity_check_mps2_absent AS gravity_check_mps2_absent,
  f.extrapolated_gap_m / 0.001 AS extrapolated_gap_mm,
  f.extrapolated_gap_m_u / 0.001 AS extrapolated_gap_u_mm,
  f.extrapolated_gap_m_low / 0.001 AS extrapolated_gap_low_mm,
  f.extrapolated_gap_m_high / 0.001 AS extrapolated_gap_high_mm,
  f.extrapolated_gap_m_absent AS extrapolated_gap_mm_absent
FROM trials t
JOIN revisions r ON r.trial_id = t.id AND r.number =
  (SELECT max(number) FROM revisions
   WHERE trial_id = t.id AND kind <> 'proposed')
JOIN statements s ON s.revision_id = r.statement_id
LEFT JOIN campaigns c ON c.id = t.campaign_id
JOIN contacts f ON f.revision_id = s.revision_id
ORDER BY t.id, f.ordinal;
CREATE VIEW v_revisions AS SELECT
  t.uuid AS trial,
  c.name AS campaign,
  r.number AS revision,
  r.kind AS kind,
  r.author AS author,
  nullif(r.reason, '') AS reason,
  r.recorded_at_utc AS recorded_at_utc,
  (SELECT sha256 FROM chain WHERE subject = 'revision' AND key = r.uuid) AS sha256
FROM revisions r JOIN trials t ON t.id = r.trial_id
LEFT JOIN campaigns c ON c.id = t.campaign_id
ORDER BY t.id, r.number;
CREATE VIEW v_tracks AS SELECT
  t.uuid AS trial,
  c.name AS campaign,
  json_extract('[' || replace(p.value, ' ', ',') || ']', '$[0]') AS frame,
  json_extract('[' || replace(p.value, ' ', ',') || ']', '$[1]') AS time_s,
  json_extract('[' || replace(p.value, ' ', ',') || ']', '$[2]') AS x_mm,
  json_extract('[' || replace(p.value, ' ', ',') || ']', '$[3]') AS y_mm,
  json_extract('[' || replace(p.value, ' ', ',') || ']', '$[4]') AS gap_mm,
  json_extract('[' || replace(p.value, ' ', ',') || ']', '$[5]') AS face_angle_deg
FROM trials t
JOIN revisions r ON r.trial_id = t.id AND r.number =
  (SELECT max(number) FROM revisions
   WHERE trial_id = t.id AND kind <> 'proposed')
JOIN statements s ON s.revision_id = r.statement_id
LEFT JOIN campaigns c ON c.id = t.campaign_id
JOIN json_each(CASE WHEN json_valid(s.document_json)
  THEN s.document_json ELSE '{}' END, '$.path.rows') p
ORDER BY t.id, p.id;
CREATE VIEW v_trials AS SELECT
  t.uuid AS trial,
  c.name AS campaign,
  t.origin AS origin,
  t.logged_at_utc AS logged_at_utc,
  r.number AS revision,
  r.recorded_at_utc AS revised_at_utc,
  r.author AS author,
  nullif(r.reason, '') AS reason,
  r.exclusion_id IS NOT NULL AS excluded,
  x.reason AS exclusion_reason,
  s.body_kind AS body_kind,
  s.diameter_m / 0.001 AS diameter_mm,
  s.diameter_m_u / 0.001 AS diameter_u_mm,
  s.diameter_m_low / 0.001 AS diameter_low_mm,
  s.diameter_m_high / 0.001 AS diameter_high_mm,
  s.diameter_m_absent AS diameter_mm_absent,
  s.long_m / 0.001 AS long_mm,
  s.long_m_u / 0.001 AS long_u_mm,
  s.long_m_low / 0.001 AS long_low_mm,
  s.long_m_high / 0.001 AS long_high_mm,
  s.long_m_absent AS long_mm_absent,
  s.short_m / 0.001 AS short_mm,
  s.short_m_u / 0.001 AS short_u_mm,
  s.short_m_low / 0.001 AS short_low_mm,
  s.short_m_high / 0.001 AS short_high_mm,
  s.short_m_absent AS short_mm_absent,
  s.set_angle_rad / 0.017453292519943295 AS set_angle_deg,
  s.set_speed_mps AS set_speed_mps,
  s.angle_kind AS angle_kind,
  CASE s.angle_kind WHEN 'radius' THEN f.radius_angle_rad WHEN 'face' THEN abs(f.face_angle_rad) ELSE f.approach_angle_rad END / 0.017453292519943295 AS contact_angle_deg,
  CASE s.angle_kind WHEN 'radius' THEN f.radius_angle_rad_u WHEN 'face' THEN f.face_angle_rad_u ELSE f.approach_angle_rad_u END / 0.017453292519943295 AS contact_angle_u_deg,
  CASE s.angle_kind WHEN 'radius' THEN f.radius_angle_rad_low WHEN 'face' THEN CASE WHEN f.face_angle_rad < 0 THEN -f.face_angle_rad_high ELSE f.face_angle_rad_low END ELSE f.approach_angle_rad_low END / 0.017453292519943295 AS contact_angle_low_deg,
  CASE s.angle_kind WHEN 'radius' THEN f.radius_angle_rad_high WHEN 'face' THEN CASE WHEN f.face_angle_rad < 0 THEN -f.face_angle_rad_low ELSE f.face_angle_rad_high END ELSE f.approach_angle_rad_high END / 0.017453292519943295 AS contact_angle_high_deg,
  CASE s.angle_kind WHEN 'radius' THEN f.radius_angle_rad_absent WHEN 'face' THEN f.face_angle_rad_absent ELSE f.approach_angle_rad_absent END AS contact_angle_deg_absent,
  f.state AS state,
  f.p_bounce AS p_bounce,
  f.state_because AS state_because,
  s.contacts AS contacts,
  (SELECT name FROM rigs WHERE id = o.rig_id) AS rig,
  (SELECT name FROM springs WHERE id = o.spring_id) AS spring,
  (SELECT name FROM cameras WHERE id = o.camera_id) AS camera,
  (SELECT name FROM calibrations WHERE id = o.calibration_id) AS calibration,
  (SELECT name FROM bodies WHERE id = o.body_id) AS body,
  (SELECT name FROM surfaces WHERE id = o.surface_id) AS surface,
  (SELECT name FROM operators WHERE id = o.operator_id) AS operator,
  (o.temperature_k - 273.15) AS temperature_c,
  o.temperature_k_u AS temperature_u_c,
  (o.temperature_k_low - 273.15) AS temperature_low_c,
  (o.temperature_k_high - 273.15) AS temperature_high_c,
  o.temperature_k_absent AS temperature_c_absent,
  o.relative_humidity AS relative_humidity,
  o.relative_humidity_u AS relative_humidity_u,
  o.relative_humidity_low AS relative_humidity_low,
  o.relative_humidity_high AS relative_humidity_high,
  o.relative_humidity_absent AS relative_humidity_absent,
  o.elevation_rad / 0.017453292519943295 AS elevation_deg,
  o.elevation_rad_u / 0.017453292519943295 AS elevation_u_deg,
  o.elevation_rad_low / 0.017453292519943295 AS elevation_low_deg,
  o.elevation_rad_high / 0.017453292519943295 AS elevation_high_deg,
  o.elevation_rad_absent AS elevation_deg_absent,
  o.compression_m / 0.001 AS compression_mm,
  o.compression_m_u / 0.001 AS compression_u_mm,
  o.compression_m_low / 0.001 AS compression_low_mm,
  o.compression_m_high / 0.001 AS compression_high_mm,
  o.compression_m_absent AS compression_mm_absent,
  o.muzzle_height_m / 0.001 AS muzzle_height_mm,
  o.muzzle_height_m_u / 0.001 AS muzzle_height_u_mm,
  o.muzzle_height_m_low / 0.001 AS muzzle_height_low_mm,
  o.muzzle_height_m_high / 0.001 AS muzzle_height_high_mm,
  o.muzzle_height_m_absent AS muzzle_height_mm_absent,
  o.anomaly AS anomaly,
  nullif(o.anomaly_note, '') AS anomaly_note,
  nullif(o.note, '') AS note,
  nullif(s.clip_path, '') AS clip_path,
  k.clip_id AS clip_id,
  k.sha256 AS clip_sha256,
  k.size_bytes AS clip_size_bytes,
  nullif(s.software_version, '') AS software_version,
  nullif(s.options_hash, '') AS options_hash
FROM trials t
JOIN revisions r ON r.trial_id = t.id AND r.number =
  (SELECT max(number) FROM revisions
   WHERE trial_id = t.id AND kind <> 'proposed')
JOIN statements s ON s.revision_id = r.statement_id
LEFT JOIN campaigns c ON c.id = t.campaign_id
JOIN contacts f ON f.revision_id = s.revision_id AND f.ordinal = 0
LEFT JOIN clips k ON k.id = t.clip_id
LEFT JOIN exclusions x ON x.revision_id = r.exclusion_id
LEFT JOIN conditions o ON o.revision_id = r.conditions_id
ORDER BY t.id;
CREATE TRIGGER bodies_refuse_DELETE BEFORE DELETE ON bodies BEGIN
  SELECT raise(ABORT, 'bodies are kept: add a version');
END;
CREATE TRIGGER bodies_refuse_REPLACE BEFORE INSERT ON bodies
WHEN EXISTS (SELECT 1 FROM bodies WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM bodies WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'bodies are kept: add a version');
END;
CREATE TRIGGER bodies_refuse_UPDATE BEFORE UPDATE ON bodies BEGIN
  SELECT raise(ABORT, 'bodies are kept: add a version');
END;
CREATE TRIGGER budget_lines_refuse_DELETE BEFORE DELETE ON budget_lines BEGIN
  SELECT raise(ABORT, 'budget_lines is append-only: add a revision');
END;
CREATE TRIGGER budget_lines_refuse_REPLACE BEFORE INSERT ON budget_lines
WHEN EXISTS (SELECT 1 FROM budget_lines
             WHERE revision_id = NEW.revision_id
             AND ordinal = NEW.ordinal AND budget = NEW.budget
             AND line = NEW.line)
BEGIN SELECT raise(ABORT, 'budget_lines is append-only: add a revision');
END;
CREATE TRIGGER budget_lines_refuse_UPDATE BEFORE UPDATE ON budget_lines BEGIN
  SELECT raise(ABORT, 'budget_lines is append-only: add a revision');
END;
CREATE TRIGGER calibrations_refuse_DELETE BEFORE DELETE ON calibrations BEGIN
  SELECT raise(ABORT, 'calibrations are kept: add a version');
END;
CREATE TRIGGER calibrations_refuse_REPLACE BEFORE INSERT ON calibrations
WHEN EXISTS (SELECT 1 FROM calibrations WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM calibrations WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'calibrations are kept: add a version');
END;
CREATE TRIGGER calibrations_refuse_UPDATE BEFORE UPDATE ON calibrations BEGIN
  SELECT raise(ABORT, 'calibrations are kept: add a version');
END;
CREATE TRIGGER cameras_refuse_DELETE BEFORE DELETE ON cameras BEGIN
  SELECT raise(ABORT, 'cameras are kept: add a version');
END;
CREATE TRIGGER cameras_refuse_REPLACE BEFORE INSERT ON cameras
WHEN EXISTS (SELECT 1 FROM cameras WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM cameras WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'cameras are kept: add a version');
END;
CREATE TRIGGER cameras_refuse_UPDATE BEFORE UPDATE ON cameras BEGIN
  SELECT raise(ABORT, 'cameras are kept: add a version');
END;
CREATE TRIGGER campaigns_keep_conventions BEFORE UPDATE ON campaigns
WHEN EXISTS (SELECT 1 FROM trials WHERE campaign_id = OLD.id)
BEGIN SELECT raise(ABORT, 'a campaign with trials keeps its conventions'); END;
CREATE TRIGGER campaigns_refuse_DELETE BEFORE DELETE ON campaigns
BEGIN SELECT raise(ABORT, 'campaigns are kept'); END;
CREATE TRIGGER campaigns_refuse_REPLACE BEFORE INSERT ON campaigns
WHEN EXISTS (SELECT 1 FROM campaigns WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM campaigns WHERE uuid = NEW.uuid)
  OR EXISTS (SELECT 1 FROM campaigns WHERE name = NEW.name)
BEGIN SELECT raise(ABORT, 'campaigns are kept'); END;
CREATE TRIGGER chain_grows BEFORE INSERT ON chain
WHEN NEW.number <> 1 + (SELECT ifnull(max(number), 0) FROM chain)
  OR EXISTS (SELECT 1 FROM chain WHERE subject = NEW.subject
             AND key = NEW.key)
BEGIN SELECT raise(ABORT, 'the chain grows link by link'); END;
CREATE TRIGGER chain_refuse_DELETE BEFORE DELETE ON chain
BEGIN SELECT raise(ABORT, 'the chain is kept'); END;
CREATE TRIGGER chain_refuse_UPDATE BEFORE UPDATE ON chain
BEGIN SELECT raise(ABORT, 'the chain is kept'); END;
CREATE TRIGGER clips_keep_digest BEFORE UPDATE ON clips
WHEN NEW.clip_id <> OLD.clip_id OR NEW.size_bytes <> OLD.size_bytes
  OR (OLD.sha256 IS NOT NULL AND NEW.sha256 IS NOT OLD.sha256)
BEGIN SELECT raise(ABORT, 'a clip keeps its digest'); END;
CREATE TRIGGER clips_refuse_DELETE BEFORE DELETE ON clips
BEGIN SELECT raise(ABORT, 'clips are kept'); END;
CREATE TRIGGER clips_refuse_REPLACE BEFORE INSERT ON clips
WHEN EXISTS (SELECT 1 FROM clips WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM clips WHERE clip_id = NEW.clip_id
             AND sha256 = NEW.sha256)
BEGIN SELECT raise(ABORT, 'clips are kept'); END;
CREATE TRIGGER conditions_refuse_DELETE BEFORE DELETE ON conditions BEGIN
  SELECT raise(ABORT, 'conditions is append-only: add a revision');
END;
CREATE TRIGGER conditions_refuse_REPLACE BEFORE INSERT ON conditions
WHEN EXISTS (SELECT 1 FROM conditions WHERE revision_id = NEW.revision_id)
BEGIN SELECT raise(ABORT, 'conditions is append-only: add a revision');
END;
CREATE TRIGGER conditions_refuse_UPDATE BEFORE UPDATE ON conditions BEGIN
  SELECT raise(ABORT, 'conditions is append-only: add a revision');
END;
CREATE TRIGGER contacts_refuse_DELETE BEFORE DELETE ON contacts BEGIN
  SELECT raise(ABORT, 'contacts is append-only: add a revision');
END;
CREATE TRIGGER contacts_refuse_REPLACE BEFORE INSERT ON contacts
WHEN NEW.ordinal >= (SELECT contacts FROM statements
                     WHERE revision_id = NEW.revision_id)
  OR EXISTS (SELECT 1 FROM contacts WHERE ordinal = NEW.ordinal
             AND revision_id = NEW.revision_id)
  OR EXISTS (SELECT 1 FROM contacts WHERE rowid = NEW.rowid)
BEGIN SELECT raise(ABORT, 'contacts is append-only: add a revision');
END;
CREATE TRIGGER contacts_refuse_UPDATE BEFORE UPDATE ON contacts BEGIN
  SELECT raise(ABORT, 'contacts is append-only: add a revision');
END;
CREATE TRIGGER exclusions_refuse_DELETE BEFORE DELETE ON exclusions BEGIN
  SELECT raise(ABORT, 'exclusions is append-only: add a revision');
END;
CREATE TRIGGER exclusions_refuse_REPLACE BEFORE INSERT ON exclusions
WHEN EXISTS (SELECT 1 FROM exclusions WHERE revision_id = NEW.revision_id)
BEGIN SELECT raise(ABORT, 'exclusions is append-only: add a revision');
END;
CREATE TRIGGER exclusions_refuse_UPDATE BEFORE UPDATE ON exclusions BEGIN
  SELECT raise(ABORT, 'exclusions is append-only: add a revision');
END;
CREATE TRIGGER operators_refuse_DELETE BEFORE DELETE ON operators BEGIN
  SELECT raise(ABORT, 'operators are kept: add a version');
END;
CREATE TRIGGER operators_refuse_REPLACE BEFORE INSERT ON operators
WHEN EXISTS (SELECT 1 FROM operators WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM operators WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'operators are kept: add a version');
END;
CREATE TRIGGER operators_refuse_UPDATE BEFORE UPDATE ON operators BEGIN
  SELECT raise(ABORT, 'operators are kept: add a version');
END;
CREATE TRIGGER plan_events_refuse_DELETE BEFORE DELETE ON plan_events
BEGIN SELECT raise(ABORT, 'plan_events are kept'); END;
CREATE TRIGGER plan_events_refuse_REPLACE BEFORE INSERT ON plan_events
WHEN EXISTS (SELECT 1 FROM plan_events WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM plan_events WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'plan_events are kept'); END;
CREATE TRIGGER plan_events_refuse_UPDATE BEFORE UPDATE ON plan_events
BEGIN SELECT raise(ABORT, 'plan_events are kept'); END;
CREATE TRIGGER revisions_in_order BEFORE INSERT ON revisions
WHEN NEW.number <> 1 + (SELECT ifnull(max(number), 0) FROM revisions
                        WHERE trial_id = NEW.trial_id)
  OR EXISTS (SELECT 1 FROM revisions WHERE uuid = NEW.uuid)
  OR EXISTS (SELECT 1 FROM revisions WHERE id = NEW.id)
BEGIN SELECT raise(ABORT, 'revisions are added one after the other');
END;
CREATE TRIGGER revisions_refuse_DELETE BEFORE DELETE ON revisions BEGIN
  SELECT raise(ABORT, 'revisions is append-only: add a revision');
END;
CREATE TRIGGER revisions_refuse_UPDATE BEFORE UPDATE ON revisions BEGIN
  SELECT raise(ABORT, 'revisions is append-only: add a revision');
END;
CREATE TRIGGER rigs_refuse_DELETE BEFORE DELETE ON rigs BEGIN
  SELECT raise(ABORT, 'rigs are kept: add a version');
END;
CREATE TRIGGER rigs_refuse_REPLACE BEFORE INSERT ON rigs
WHEN EXISTS (SELECT 1 FROM rigs WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM rigs WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'rigs are kept: add a version');
END;
CREATE TRIGGER rigs_refuse_UPDATE BEFORE UPDATE ON rigs BEGIN
  SELECT raise(ABORT, 'rigs are kept: add a version');
END;
CREATE TRIGGER springs_refuse_DELETE BEFORE DELETE ON springs BEGIN
  SELECT raise(ABORT, 'springs are kept: add a version');
END;
CREATE TRIGGER springs_refuse_REPLACE BEFORE INSERT ON springs
WHEN EXISTS (SELECT 1 FROM springs WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM springs WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'springs are kept: add a version');
END;
CREATE TRIGGER springs_refuse_UPDATE BEFORE UPDATE ON springs BEGIN
  SELECT raise(ABORT, 'springs are kept: add a version');
END;
CREATE TRIGGER statements_refuse_DELETE BEFORE DELETE ON statements BEGIN
  SELECT raise(ABORT, 'statements is append-only: add a revision');
END;
CREATE TRIGGER statements_refuse_REPLACE BEFORE INSERT ON statements
WHEN EXISTS (SELECT 1 FROM statements WHERE revision_id = NEW.revision_id)
BEGIN SELECT raise(ABORT, 'statements is append-only: add a revision');
END;
CREATE TRIGGER statements_refuse_UPDATE BEFORE UPDATE ON statements BEGIN
  SELECT raise(ABORT, 'statements is append-only: add a revision');
END;
CREATE TRIGGER surfaces_refuse_DELETE BEFORE DELETE ON surfaces BEGIN
  SELECT raise(ABORT, 'surfaces are kept: add a version');
END;
CREATE TRIGGER surfaces_refuse_REPLACE BEFORE INSERT ON surfaces
WHEN EXISTS (SELECT 1 FROM surfaces WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM surfaces WHERE uuid = NEW.uuid)
BEGIN SELECT raise(ABORT, 'surfaces are kept: add a version');
END;
CREATE TRIGGER surfaces_refuse_UPDATE BEFORE UPDATE ON surfaces BEGIN
  SELECT raise(ABORT, 'surfaces are kept: add a version');
END;
CREATE TRIGGER trials_refuse_DELETE BEFORE DELETE ON trials BEGIN
  SELECT raise(ABORT, 'trials is append-only: add a revision');
END;
CREATE TRIGGER trials_refuse_REPLACE BEFORE INSERT ON trials
WHEN EXISTS (SELECT 1 FROM trials WHERE uuid = NEW.uuid)
  OR EXISTS (SELECT 1 FROM trials WHERE id = NEW.id)
  OR EXISTS (SELECT 1 FROM trials
             WHERE ifnull(campaign_id, 0) = ifnull(NEW.campaign_id, 0)
             AND clip_id = NEW.clip_id)
BEGIN SELECT raise(ABORT, 'this trial exists already'); END;
CREATE TRIGGER trials_refuse_UPDATE BEFORE UPDATE ON trials BEGIN
  SELECT raise(ABORT, 'trials is append-only: add a revision');
END;
COMMIT;

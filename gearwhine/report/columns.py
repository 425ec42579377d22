"""The columns of a report's tables: the key of a command's document, the heading with its unit, how it is written."""

from gearwhine.report.tables import Column

MODES = (
    Column("number", "mode", "d"),
    Column("frequency_hz", "frequency [Hz]", ".2f"),
    Column("damping_ratio", "damping ratio", ".4f"),
    Column("strength", "strength [1/kg]", ".4g"),
)
PAIRS = (
    Column("measured_hz", "measured [Hz]", ".1f"),
    Column("model_hz", "model [Hz]", ".1f"),
    Column("error_percent", "error [%]", "+.2f"),
    Column("mode", "mode", "d"),
    Column("mac", "MAC", ".3f"),
    Column("confidence", "confidence", ".2f"),
    Column("strength", "strength [1/kg]", ".4g"),
)
GEARS = (
    Column("driver", "driver"),
    Column("driven", "driven"),
    Column("contact_ratio", "contact ratio", ".4f"),
    Column("mesh_frequency_hz", "mesh frequency [Hz]", ".2f"),
    Column("stiffness_n_per_m.mean", "mean stiffness [N/µm]", ".1f", 1e-6),
    Column("transmission_error_m.mean", "mean transmission error [µm]", ".2f", 1e6),
    Column("transmission_error_m.peak_to_peak", "peak to peak [µm]", ".3f", 1e6),
)
MESHES = (
    Column("driver", "driver"),
    Column("driven", "driven"),
    Column("mean_force_n", "mean force [N]", ".0f"),
    Column("peak_force_n", "largest force [N]", ".0f"),
    Column("contact_loss_fraction", "apart [%]", ".2f", 100.0),
    Column("friction.mean_power_w", "friction takes [W]", ".3g"),
    Column("rms_compression_m", "a.c. compression [µm rms]", ".3g", 1e6),
)
ORDERS = (
    Column("signal", "signal"),
    Column("name", "order"),
    Column("highest_amplitude", "highest [peak]", ".3g"),
    Column("unit", "unit"),
    Column("at_rpm", "at [rpm]", ".0f"),
    Column("frequency_hz", "that is [Hz]", ".0f"),
)
LINES = (
    Column("sensor", "sensor"),
    Column("frequency_hz", "line [Hz]", ".1f"),
    Column("amplitude_m_per_s2", "amplitude [m/s², peak]", ".3g"),
    Column("level_db", "level [dB re 1e-6 m/s²]", ".1f"),
    Column("uncertainty", "± by the modal basis [%]", ".1f", 100.0),
    Column("name", "what it is"),
    Column("by", "mostly by"),
)
SYSTEM = (
    Column("frequency_hz", "frequency [Hz]", ".2f"),
    Column("damping_ratio", "damping ratio", ".4f"),
    Column("kind", "kind"),
    Column("where", "where"),
)
ROTORS = (
    Column("name", "rotor"),
    Column("mass_kg", "mass [kg]", ".3f"),
    Column("lateral_hz", "bending at rest [Hz]", ".1f"),
    Column("torsional_hz", "torsion [Hz]", ".1f"),
    Column("axial_hz", "along the axis [Hz]", ".1f"),
    Column("critical_speeds_rpm", "critical speeds [rpm]", ".0f"),
)
BEARINGS = (
    Column("name", "bearing"),
    Column("mean_force_n", "mean force x, y, z [N]", ".1f"),
    Column("rms_force_n", "a.c. force x, y, z [N rms]", ".2f"),
    Column("mean_moment_n_m", "mean moment x, y [N m]", ".2f"),
)
PARAMETERS = (
    Column("name", "parameter"),
    Column("before", "before (SI)", ".5g"),
    Column("after", "after (SI)", ".5g"),
    Column("standard_deviation", "± (SI)", ".2g"),
)
HELD_BACK = (
    Column("measured_hz", "held back [Hz]", ".1f"),
    Column("predicted_hz", "predicted [Hz]", ".1f"),
    Column("error_percent", "error [%]", "+.2f"),
    Column("standard_deviation_percent", "expected ± [%]", ".2f"),
    Column("before_error_percent", "error before [%]", "+.2f"),
    Column("rms_error_percent_of_the_others", "rms of the others [%]", ".2f"),
)
EVENTS = (Column("speed_rpm", "speed [rpm]", ".1f"), Column("kind", "what happens"))

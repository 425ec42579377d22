"""The columns of a report's tables: the key of a command's document, the heading with its unit, how it is written."""

from gearwhine.output.sections import Column

MESHES = (
    Column("driver", "driver"),
    Column("driven", "driven"),
    Column("mean force [N]", "mean_force_n", ".0f"),
    Column("largest force [N]", "peak_force_n", ".0f"),
    Column("apart [%]", "contact_loss_fraction", ".2f", 100.0),
    Column("friction takes [W]", "friction.mean_power_w", ".3g"),
    Column("a.c. compression [µm rms]", "rms_compression_m", ".3g", 1e6),
)
ORDERS = (
    Column("signal", "signal"),
    Column("order", "name"),
    Column("highest [peak]", "highest_amplitude", ".3g"),
    Column("unit", "unit"),
    Column("at [rpm]", "at_rpm", ".0f"),
    Column("that is [Hz]", "frequency_hz", ".0f"),
)
LINES = (
    Column("sensor", "sensor"),
    Column("line [Hz]", "frequency_hz", ".1f"),
    Column("amplitude [m/s², peak]", "amplitude_m_per_s2", ".3g"),
    Column("level [dB re 1e-6 m/s²]", "level_db", ".1f"),
    Column("± by the modal basis [%]", "uncertainty", ".1f", 100.0),
    Column("what it is", "name"),
    Column("mostly by", "by"),
)
SYSTEM = (
    Column("frequency [Hz]", "frequency_hz", ".2f"),
    Column("damping ratio", "damping_ratio", ".4f"),
    Column("kind", "kind"),
    Column("where", "where"),
)
BEARINGS = (
    Column("bearing", "name"),
    Column("mean force x, y, z [N]", "mean_force_n", ".1f"),
    Column("a.c. force x, y, z [N rms]", "rms_force_n", ".2f"),
    Column("mean moment x, y [N m]", "mean_moment_n_m", ".2f"),
)
EVENTS = (Column("speed [rpm]", "speed_rpm", ".1f"), Column("what happens", "kind"))

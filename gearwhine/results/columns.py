"""The columns of a report's tables: the key of a command's document, the heading with its unit, how it is written."""

from gearwhine.output.sections import Column

MODES = (
    Column("mode", "number", "d"),
    Column("frequency [Hz]", "frequency_hz", ".2f"),
    Column("damping ratio", "damping_ratio", ".4f"),
    Column("strength [1/kg]", "strength", ".4g"),
)
PAIRS = (
    Column("measured [Hz]", "measured_hz", ".1f"),
    Column("model [Hz]", "model_hz", ".1f"),
    Column("error [%]", "error_percent", "+.2f"),
    Column("mode", "mode", "d"),
    Column("MAC", "mac", ".3f"),
    Column("confidence", "confidence", ".2f"),
    Column("strength [1/kg]", "strength", ".4g"),
)
PARAMETERS = (
    Column("parameter", "name"),
    Column("before (SI)", "before", ".5g"),
    Column("after (SI)", "after", ".5g"),
    Column("± (SI)", "standard_deviation", ".2g"),
)
HELD_BACK = (
    Column("held back [Hz]", "measured_hz", ".1f"),
    Column("predicted [Hz]", "predicted_hz", ".1f"),
    Column("error [%]", "error_percent", "+.2f"),
    Column("expected ± [%]", "standard_deviation_percent", ".2f"),
    Column("error before [%]", "before_error_percent", "+.2f"),
    Column("rms of the others [%]", "rms_error_percent_of_the_others", ".2f"),
)

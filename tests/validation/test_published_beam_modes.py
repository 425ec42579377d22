"""The free beam of pyEMA, the example that sdypy-EMA publishes: frequencies, modal constants and auto-MAC.

sdypy-EMA, tests/test_data.py (MIT, https://github.com/sdypy/sdypy-EMA): natural frequencies `nat_freq_true`, modal
constants `complex_modes_true` of six places to one accelerometer, auto-MAC `mac_true`; damping ratios from its
showcase notebook. The measured responses themselves (data/acc_data.npy) are neither in its wheel nor in its source
archive, so that they cannot be read here: accelerances are synthesised from the published constants, and the modes
found in them by the rule of :mod:`gearwhine.housing.measured.identification`. What this proves is that the rule and the
estimators give the published modes back at their true spacing, damping and complexity; not that they do so from
the noise of that test.
"""

import numpy as np

from gearwhine.housing.measured import MeasuredGeometry, MeasuredResponses, identify_modes

FREQUENCIES_HZ = np.array(
    [176.07332578, 476.4634351, 932.28540465, 1534.78951957, 2286.31989538, 3162.15866336, 4181.71710178]
)
DAMPING = np.array([0.0086, 0.0020, 0.0015, 0.0020, 0.0028, 0.0018, 0.0015])
CONSTANTS = np.array(
    [
        [
            8.78858427 - 46.25768j,
            147.828731 - 377.006628j,
            28.8980008 - 175.736863j,
            0.502619914 + 329.823843j,
            -25.0811211 - 1170.16415j,
            -285.158564 - 5630.09196j,
            -997.832494 - 7969.12501j,
        ],
        [
            -0.481462459 + 7.27528316j,
            -282.353353 + 650.374464j,
            -233.676706 + 1840.5262j,
            -15.0078029 + 570.847002j,
            35.7343241 + 741.348932j,
            300.618054 + 7014.14015j,
            809.599733 + 8893.84856j,
        ],
        [
            -5.27094605 + 32.0095343j,
            -229.079228 + 412.765641j,
            346.673938 - 1259.009j,
            133.956891 - 1290.34052j,
            -14.4047092 - 379.280216j,
            29.303025 - 7930.6977j,
            -148.418677 - 3568.17624j,
        ],
        [
            -7.44573305 + 31.0803753j,
            232.227296 - 399.570741j,
            378.683113 - 1280.15678j,
            -130.933497 + 1278.74235j,
            33.9274588 - 388.794229j,
            -187.01518 + 8081.62073j,
            -294.14502 - 3162.58445j,
        ],
        [
            1.36920344 + 4.87053971j,
            345.851072 - 577.793795j,
            -532.658463 + 1700.95296j,
            37.2113228 - 411.793431j,
            -53.7345031 + 1112.47836j,
            268.174934 - 7808.13434j,
            646.51234 + 8274.74635j,
        ],
        [
            9.27776581 - 35.0697439j,
            -178.251382 + 302.34991j,
            87.840761 - 229.426963j,
            39.5900184 - 262.794963j,
            76.1010798 - 1094.29953j,
            134.63068 + 5469.66251j,
            97.7698813 - 8104.87975j,
        ],
    ]
)  # places x modes
AUTO_MAC = np.array(
    [
        [1.0, 0.00902515351, 0.0371827973, 0.00116220047, 0.244205973, 0.00452598141, 0.181037366],
        [0.00902515351, 1.0, 0.000849283153, 0.0835112639, 0.00300653562, 0.0958444691, 0.00259570265],
        [0.0371827973, 0.000849283153, 1.0, 0.00273984973, 0.495162216, 0.00172581774, 0.616883253],
        [0.00116220047, 0.0835112639, 0.00273984973, 1.0, 0.00158600848, 0.502742321, 0.00258771991],
        [0.244205973, 0.00300653562, 0.495162216, 0.00158600848, 1.0, 0.00698982327, 0.959439695],
        [0.00452598141, 0.0958444691, 0.00172581774, 0.502742321, 0.00698982327, 1.0, 4.68264434e-05],
        [0.181037366, 0.00259570265, 0.616883253, 0.00258771991, 0.959439695, 4.68264434e-05, 1.0],
    ]
)


def test_the_published_constants_have_the_published_auto_mac() -> None:
    np.testing.assert_allclose(mac(CONSTANTS.T), AUTO_MAC, atol=2e-8)


def test_the_published_modes_come_back_from_responses_made_of_them() -> None:
    """H = (iω)² Σ [A / (iω - λ) + A* / (iω - λ*)], at the example's 4999 lines of 1.00019535 Hz."""
    omega = 2 * np.pi * 1.00019535 * np.arange(1, 5000)
    natural = 2 * np.pi * FREQUENCIES_HZ
    poles = natural * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2))
    terms = 1.0 / (1j * omega - poles[:, None]), 1.0 / (1j * omega - poles[:, None].conj())
    values = -(omega**2) * (CONSTANTS @ terms[0] + CONSTANTS.conj() @ terms[1])
    geometry = MeasuredGeometry(
        tuple("123456"), np.linspace(0, 1, 6)[:, None] * [1.0, 0, 0], np.arange(6), np.tile([0, 0, 1.0], (6, 1))
    )
    responses = MeasuredResponses(geometry, np.array([1]), np.array([[0, 0, 1.0]]), omega, values[:, None])
    found = identify_modes(responses)
    np.testing.assert_allclose(found.modes.frequencies, natural, rtol=1e-6)
    np.testing.assert_allclose(found.modes.damping_ratios, DAMPING, rtol=1e-3)
    np.testing.assert_allclose(mac(found.modes.shapes), AUTO_MAC, atol=1e-4)


def mac(shapes: np.ndarray) -> np.ndarray:
    products = np.abs(shapes.conj() @ shapes.T) ** 2
    return products / np.outer(np.diag(products), np.diag(products)) ** 0.5

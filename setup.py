"""Build hnr_planner: for ``colcon build`` (ament_python) and for ``pip install`` alike."""

from glob import glob
from pathlib import Path

from setuptools import find_packages, setup

package_name = 'hnr_planner'

setup(
    name=package_name,
    version='0.2.0',
    description='A ROS 2 planning node and library: Hit-and-Run and RRT on occupancy maps.',
    # `colcon build --symlink-install` runs it through a link in a folder of its own.
    long_description=Path(__file__).resolve().with_name('README.md').read_text(encoding='utf-8'),
    long_description_content_type='text/markdown',
    license='Apache-2.0',
    keywords='hit-and-run, motion planning, occupancy grid, random walk, ROS 2, RRT, sampling',
    classifiers=[
        'Development Status :: 4 - Beta',
        'Environment :: Console',
        'Intended Audience :: Developers',
        'Intended Audience :: Science/Research',
        'License :: OSI Approved :: Apache Software License',
        'Operating System :: POSIX :: Linux',
        'Programming Language :: Python :: 3',
        'Programming Language :: Python :: 3 :: Only',
        'Programming Language :: Python :: 3.11',
        'Programming Language :: Python :: 3.12',
        'Programming Language :: Python :: 3.13',
        'Topic :: Scientific/Engineering :: Mathematics',
        'Topic :: Scientific/Engineering',
        'Typing :: Typed',
    ],
    project_urls={'Paper': 'https://arxiv.org/abs/1610.08865'},
    maintainer='The hnr_planner developers',
    maintainer_email='maintainers@hnr-planner.example',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    package_data={
        package_name: [
            'py.typed',
            '*.pyi',
            'core/*.pyi',
            'page/*.css',
            'page/*.html',
            'page/*.js',
        ],
    },
    python_requires='>=3.11',
    # What a robot imports: the core, the maps, the server and the nodes. The lower bounds of what
    # Ubuntu 24.04 has are that system's own releases.
    install_requires=[
        'numba>=0.68',  # kernels/parts.py builds on its compiler pipeline
        'numpy>=1.26',
        'opencv-python-headless>=4.6',
        'pillow>=10.2',
        'pyyaml>=6.0',
        'scipy>=1.11',
        'shapely>=2.0',
    ],
    extras_require={
        # Pictures: `plan --plot`, `plan --html`, `sample --plot`, `demo`.
        'plot': ['matplotlib>=3.6'],
        # The command `experiment`.
        'experiments': ['joblib>=1.3', 'matplotlib>=3.6', 'tqdm>=4.66'],
        # The command `watch` and the parameter `watch_port`.
        'watch': ['matplotlib>=3.6', 'tornado>=6.4'],
        # ROS 2 Jazzy as wheels, for machines without ROS (x86-64 Linux). Never install these
        # beside a ROS from apt.
        'ros': [
            'ros-jazzy-common-interfaces==5.3.*',
            'ros-jazzy-rclpy[fastrtps]==7.1.*',
        ],
        # The command `experiment --dask`, and joblib's back end of that name.
        'cluster': ['dask>=2024.1', 'distributed>=2024.1'],
        # `sample(..., n_jobs=)`.
        'joblib': ['joblib>=1.3'],
        # For those who hand draws on to it; the package itself does without.
        'arviz': ['arviz>=0.17'],
        'test': [
            'arviz>=0.17',
            'colcon-common-extensions>=0.3',
            'hypothesis>=6.98',
            'joblib>=1.3',
            'pytest>=7.4',
            'pytest-xdist>=3.4',
            'selenium>=4.18',
            'setuptools>=64,<80',  # later ones lack what `colcon build --symlink-install` calls
        ],
        # The site. Held to one series each, as the tools below.
        'docs': [
            'furo==2025.12.*',
            'matplotlib>=3.6',
            'myst-parser==5.*',
            'sphinx==9.0.*',
            'sphinx-gallery==0.22.*',
        ],
        # Held to one series each, so that a new rule of a tool never fails an old commit.
        'check': [
            'codespell==2.4.*',
            'mypy==2.4.*',
            'ruff==0.17.*',
            'types-PyYAML>=6.0',
            # What ament_flake8 and ament_pep257 of ROS 2 Jazzy run, as Ubuntu 24.04 has it.
            'flake8==7.0.*',
            'flake8-builtins==2.1.*',
            'flake8-comprehensions==3.14.*',
            'flake8-docstrings==1.7.*',
            'flake8-import-order==0.18.*',
            'flake8-quotes==3.4.*',
            'pydocstyle==6.3.*',
        ],
    },
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml']),
        (f'share/{package_name}/launch', glob('launch/*.launch.py')),
        (f'share/{package_name}/config', glob('config/*.*')),
        (f'share/{package_name}/config/maps', glob('config/maps/*.*')),
        # pip puts console scripts into bin/, where `ros2 run` does not look; colcon puts them
        # here and lets its own stand.
        (f'lib/{package_name}', ['scripts/map_node', 'scripts/planner_node']),
    ],
    zip_safe=False,  # the kernels' cache is keyed by their source files
    entry_points={
        'console_scripts': [
            'hnr-planner = hnr_planner.cli.main:main',
            'map_node = hnr_planner.ros.node.map_node:main',
            'planner_node = hnr_planner.ros.node.planner_node:main',
        ],
    },
)

# La pagina dei comandi del simulatore.

simulator-title = Simulatore
simulator-viewer = Accesso come osservatore: si vede il simulatore e si può premere STOP. Per tutto il resto serve la chiave di un operatore.
simulator-about = Quello che si fa qui si fa alla sala simulata e ai suoi robot, e non alla missione: un simulatore in pausa è un robot che non va avanti. STOP lo ferma lo stesso, subito.

## Il tempo.

simulator-time = Tempo
simulator-paused = In pausa: il tempo simulato è fermo.
simulator-runs = In corso a { $factor } × il tempo reale.
simulator-runs-max = In corso alla massima velocità possibile.
simulator-go-on = Riprendere
simulator-pause = Pausa
simulator-step = Un passo<small>fino alla fine dell'ordine in corso</small>
simulator-step-unpaused = Un passo<small>quando è in pausa</small>
simulator-speed = Velocità
simulator-speed-max = la massima possibile
simulator-set-speed = Impostare la velocità

## I guasti del robot, con il nome di quello che succede.

simulator-faults = Guasti del robot
simulator-well-linkLost = Collegamento: a posto
simulator-failing-linkLost = Collegamento: interrotto
simulator-means-linkLost = senza, il robot si ferma da solo e la missione è bloccata
simulator-bring-linkLost = Interrompere il collegamento
simulator-mend-linkLost = Ripristinare il collegamento
simulator-well-noThermometer = Termometro: a posto
simulator-failing-noThermometer = Termometro: mancante
simulator-means-noThermometer = senza, dal robot non arriva alcuna misura
simulator-bring-noThermometer = Togliere il termometro
simulator-mend-noThermometer = Rimettere il termometro
simulator-well-cameraFails = Fotocamera: a posto
simulator-failing-cameraFails = Fotocamera: guasta
simulator-means-cameraFails = quando è guasta, nessuna foto riesce
simulator-bring-cameraFails = Guastare la fotocamera
simulator-mend-cameraFails = Riparare la fotocamera

## Un passaggio ostruito.

simulator-way = Un passaggio ostruito
simulator-way-about = Un ostacolo che non fa parte della sala. Dove c'è un robot, viene messo appena il robot si è spostato.
simulator-block-ahead = Ostruire il passaggio davanti
simulator-block = Ostruire questa cella
simulator-free = Liberare { $cell }
simulator-nothing-blocked = Nessun passaggio è ostruito.

## La sala.

simulator-hall = Sala
simulator-hall-now = I robot sono in <b>{ $hall }</b>: { $columns } × { $rows } celle di { $side } m, { $pieces ->
    [one] { $pieces } bagaglio
   *[other] { $pieces } bagagli
}; seme { $seed }.
simulator-seed = Seme
simulator-put-down = Collocare i robot in quella sala
simulator-bound = Al momento: { $why }.
simulator-to-editor = Modificare la sala
simulator-start = AVVIA la ricerca
